"""Fields that are identified: fits, ways, and the experiment's own movements."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from models import MeasurementError
from models.contact import UPRIGHT
from sim.experiments import identification
from sim.experiments.identification import (
    SPAN,
    _approach,
    _check,
    _fit,
    _size,
    creep_floor,
    follows_commands,
    swing,
    whole_range,
)
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

ACCELERATION = 5.0  # [rad/s^2], at least
HOLD = 0.5  # [s], at most; a robot has settled by then
LONGEST_STAND = 10.0  # [s], that creep is measured for
SPEED = 0.5  # [rad/s], at least


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line"))


def test_twists_are_derivatives_of_poses_in_the_bodys_frame():
    """Of a body that turns as it goes along a curve, known by its formula."""
    way = np.linspace(-0.25, 0.25, 300)
    x, y, yaw = (
        0.1 * np.sin(2 * way),
        0.05 * way**2 - 0.2 * way,
        0.8 * way + 0.3 * way**2 + 3.0,
    )
    wrapped = (yaw + np.pi) % (2 * np.pi) - np.pi
    found = _fit(way, np.stack([x, y, wrapped], axis=1), 0.25)
    at = np.array([-0.2, 0.0, 0.13])
    vx, vy = 0.2 * np.cos(2 * at), 0.1 * at - 0.2
    turned = 0.8 * at + 0.3 * at**2 + 3.0
    forward = np.cos(turned) * vx + np.sin(turned) * vy
    left = np.cos(turned) * vy - np.sin(turned) * vx
    turn = 0.8 + 0.6 * at
    for part, best in zip(found, (forward, left, turn), strict=True):
        assert part(at) == pytest.approx(best, abs=1e-6)


def test_sizes_are_of_place_and_of_yaw_at_an_arm():
    poses = np.array([[3.0, 4.0, 0.0], [0.0, 0.0, -2.0], [3.0, 4.0, 1.0]])
    assert _size(poses, 0.5) == pytest.approx([5.0, 1.0, 5.5])


def test_legs_are_brought_to_an_end_through_the_air(setup):
    equations = setup.equations
    groups = len(setup.robot.groups)
    for name, direction in equations.swings.items():
        if not any(equations.twists[name]):
            continue
        flows = _approach(setup, direction, -0.2)
        moved = np.zeros(groups)
        for flow in flows:
            moved += np.multiply(equations.swings[flow.field], flow.duration)
            assert not any(equations.twists[flow.field])
            assert flow.stratum == equations.system.stratum_of[flow.field]
        assert moved == pytest.approx(-0.2 * np.array(direction))


@pytest.fixture
def laid(setup, monkeypatch):
    """What a swing would have been played as."""
    kept = {}

    def recorded(model, robot, commands, every, looks):
        kept.update(commands=np.concatenate(list(commands)), every=every, looks=looks)
        raise MeasurementError("seen")

    monkeypatch.setattr(identification, "recorded", recorded)
    return kept


def test_a_swing_leads_from_one_end_to_the_other_at_the_pace_of_walks(setup, laid):
    name = next(n for n, twist in setup.equations.twists.items() if any(twist))
    with pytest.raises(MeasurementError, match="seen"):
        swing(setup, name, 0.2)
    (begin,) = laid["looks"]
    angles = setup.robot.swing_joints
    columns = [setup.model.actuator(j).id for j in angles]
    legs = laid["commands"][:, columns]
    direction = np.array(setup.equations.swings[name])
    own = setup.robot.group_of_leg
    rest = np.array([setup.robot.standing_angle(j) for j in angles])
    moved = (legs - rest) / setup.robot.swing_gain
    moving = direction[own] != 0
    assert moved[begin - 1, moving] == pytest.approx(
        -0.2 * direction[own][moving], abs=1e-9
    )
    assert moved[-1, moving] == pytest.approx(0.2 * direction[own][moving], abs=1e-9)
    speed = np.abs(np.diff(moved[begin:], axis=0)).max() / setup.limits.timestep
    fastest = max(setup.limits.swing_speed, SPEED)
    assert 0.9 * fastest < speed <= fastest * 1.001 or len(moved) < 2000
    steps = len(moved) - begin
    assert laid["every"] == max(steps // 400, 1)


@pytest.mark.parametrize("slow", [True, False])
def test_slow_walks_are_identified_at_half_a_radian_a_second(setup, laid, slow):
    limits = replace(
        setup.limits,
        swing_speed=0.1 if slow else 2.0,
        swing_acceleration=1.0 if slow else 40.0,
        hold=3.0 if slow else 0.2,
    )
    other = replace(setup)
    object.__setattr__(other, "limits", limits) if False else None
    given = SimpleNamespace(
        limits=limits, equations=setup.equations, at_rest=setup.at_rest,
        robot=setup.robot, model=setup.model, commands=setup.commands,
        scenario=setup.scenario,
    )  # fmt: skip
    name = next(n for n, twist in setup.equations.twists.items() if any(twist))
    with pytest.raises(MeasurementError, match="seen"):
        swing(given, name, 0.25)
    count = len(laid["commands"])
    hold = (HOLD if slow else 0.2) / limits.timestep
    speed, gain = (SPEED, ACCELERATION) if slow else (2.0, 40.0)
    assert laid["looks"][0] > hold
    strokes = 0.5 / speed + 1.5 * speed / gain
    assert count - laid["looks"][0] == pytest.approx(
        strokes / limits.timestep, rel=0.02
    )


def way(setup, contact, angle=0.0, rows=10):
    root = setup.robot.root_address_in(setup.model)
    qpos = np.tile(setup.model.key("start").qpos, (rows, 1))
    qpos[:, root + 3 : root + 7] = [np.cos(angle / 2), np.sin(angle / 2), 0.0, 0.0]
    return SimpleNamespace(qpos=qpos, contact=contact)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_robot_that_tilts_confirms_no_field(setup, share):
    planted = setup.robot.planted("1")
    given = way(setup, np.tile(planted, (10, 1)), share * UPRIGHT)
    if share < 1:
        _check(setup, "1", given)
    else:
        with pytest.raises(
            MeasurementError, match=f"tilts by {np.rad2deg(share * UPRIGHT):.3g} deg"
        ):
            _check(setup, "1", given)


@pytest.mark.parametrize("wrong", [5, 6])
@pytest.mark.parametrize("foot", [0, 1])
def test_feet_stand_as_planned_for_half_of_the_time(setup, wrong, foot):
    planted = setup.robot.planted("1")
    contact = np.tile(planted, (10, 1))
    contact[:wrong, foot] ^= True
    if wrong == 5:
        _check(setup, "1", way(setup, contact))
        return
    where = "in the air" if planted[foot] else "on the ground"
    leg = setup.robot.legs[foot]
    with pytest.raises(
        MeasurementError, match=f"on S1 the foot of leg {leg} stays {where}"
    ):
        _check(setup, "1", way(setup, contact))


def test_a_span_is_a_quarter_radian_or_the_whole_range(setup):
    ranges = setup.robot.swing_range
    group = setup.robot.groups[0]
    low, high = ranges[group]
    direction = tuple(float(g == group) for g in setup.robot.groups)
    assert whole_range(setup, direction) == pytest.approx(min(-low, high))
    double = tuple(2 * d for d in direction)
    assert whole_range(setup, double) == pytest.approx(min(-low, high) / 2)
    assert SPAN == 0.25


def test_predictions_follow_commands_where_loads_are_determined(setup):
    assert follows_commands(setup, "ideal", {"12"})
    assert follows_commands(setup, "quasi_static", {"1", "2"})
    assert not follows_commands(setup, "quasi_static", {"1", "12"})
    assert not follows_commands(setup, "identified", {"1"})
    assert follows_commands(setup, "quasi_static", ())


@pytest.mark.parametrize("duration", [2.0, 10.0, 25.0])
def test_creep_beyond_ten_seconds_goes_on_at_the_rate_of_the_last(
    setup, monkeypatch, duration
):
    asked = {}

    def recorded(model, robot, commands, every, looks):
        steps = sum(len(c) for c in commands)
        asked.update(steps=steps, looks=looks)
        dt = setup.limits.timestep
        slip = {int(k): np.array([1e-3 * np.sqrt(k * dt)] * 6) for k in looks}
        return SimpleNamespace(slip_after=lambda step: slip[int(step)])

    monkeypatch.setattr(identification, "recorded", recorded)
    found = creep_floor(setup, duration)
    hold, stand = setup.limits.hold, min(duration, LONGEST_STAND)
    assert asked["steps"] == pytest.approx(
        (hold + stand) / setup.limits.timestep, abs=2
    )

    def total(t):
        return 6e-3 * np.sqrt(t)

    end = hold + stand
    rate = total(end) - total(end - 1.0)  # in the last second
    best = total(end) - total(hold) + rate * (duration - stand)
    assert found == pytest.approx(best, rel=1e-2)
