"""Moments of a schedule that are looked at, and where predictions have the body."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner import Flow
from sim.motion.prediction import Predictor, _spread, commanded, inspections
from sim.motion.schedule import Scheduler
from sim.motion.stability import LeastMargin, carrying, margin_at_rest, stability_margin
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

INSPECTED_SWING = 0.02  # [rad] that the legs swing at most between inspections
LIFTS = 4  # inspections of a lift-off or touchdown
BLOCK = 20_000  # rows that are geometries at once, each of some hundred bytes


@pytest.mark.parametrize(
    ("steps", "samples", "found"),
    [
        (10, 2, [4, 9]),
        (10, 5, [2, 4, 5, 7, 9]),
        (3, 9, [1, 1, 2]),
        (1, 4, [0]),
        (100, 1, [99]),
    ],
)
def test_samples_are_even_distances_apart_and_end_with_the_last(steps, samples, found):
    spread = _spread(steps, samples)
    assert spread[-1] == steps - 1
    assert len(spread) <= samples
    even = np.linspace(0, steps - 1, min(samples, steps) + 1)[1:]
    assert np.abs(spread - np.unique(np.round(even))).max() == 0
    if samples < steps:
        assert spread.tolist() == found


def phase(kind, start, steps, amount=0.0, direction=(1.0, 0.0)):
    return SimpleNamespace(
        kind=kind, start=start, steps=steps, amount=amount, direction=direction
    )


@pytest.mark.parametrize(
    ("amount", "direction", "count"),
    [
        (0.1, (1.0, 0.0), 6),
        (-0.1, (0.5, -2.0), 11),
        (0.001, (1.0, 0.0), 2),
        (0.019, (1, 1), 2),
    ],
)
def test_legs_swing_by_a_fiftieth_of_a_radian_between_inspections(
    amount, direction, count
):
    found = inspections(
        SimpleNamespace(phases=[phase("swing", 50, 400, amount, direction)])
    )
    assert len(found) == count
    farthest = abs(amount) * max(map(abs, direction))
    assert farthest / (count - 1) <= INSPECTED_SWING
    assert found[-1] == 450
    assert found[0] > 51


def test_lifts_and_holds_are_looked_at_four_times():
    phases = [phase("hold", 0, 100), phase("lift", 100, 200), phase("land", 300, 2)]
    found = inspections(SimpleNamespace(phases=phases))
    assert len(found) == 2 * LIFTS + 2
    assert found[[3, 7, 9]].tolist() == [100, 300, 302]
    assert inspections(SimpleNamespace(phases=[])).tolist() == []


@pytest.fixture(scope="module")
def walk():
    """A hold, a stroke, a recovery and another stroke of the hexapod."""
    setup = prepare(load_scenario("line"))
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(0.1)
    swings = setup.equations.swings
    for stratum, field, amount in (
        ("1", "g1_1", 0.2),
        ("2", "g2_1", -0.2),
        ("1", "g1_1", 0.1),
    ):
        scheduler.flow(Flow(stratum, field, amount), swings[field])
    return setup, scheduler.finish()


def test_the_body_moves_in_strokes_alone_and_by_their_share(walk):
    """Twists of one metre and one radian a radian, in a frame that turns."""
    setup, schedule = walk

    def twists(stratum, swing, rates):
        moved = rates[:, 0] if stratum == "1" else 0.0 * rates[:, 0]
        return np.stack([moved, 0 * moved, 0 * moved], axis=1)

    start = (1.0, 2.0, np.pi / 2)
    predict = Predictor(schedule, twists, setup.kinematics, start)
    rows = np.arange(schedule.stop)
    pose, swing, lift = predict.configurations(rows)
    assert pose[0] == pytest.approx(np.array(start), abs=1e-9)
    assert pose[-1] == pytest.approx([1.0, 2.3, np.pi / 2])
    for one in schedule.phases:
        part = pose[one.start : one.stop, 1]
        if one.kind == "swing" and one.stratum == "1":
            own = swing[one.start : one.stop, 0]
            assert part - part[-1] == pytest.approx(own - own[-1], abs=1e-9)
        else:
            assert np.ptp(part) == pytest.approx(0.0, abs=1e-12)
    found = predict(rows)
    assert found.pose == pytest.approx(pose)
    assert (
        found.contact
        == [p.planted(setup.robot) for p in schedule.phases for _ in range(p.steps)]
    ).all()
    given = commanded(schedule, rows, setup.kinematics)
    assert given.swing == pytest.approx(swing)
    assert predict.along(given).margin == pytest.approx(found.margin)
    assert (found.further, lift.shape) == ({}, swing.shape)


def test_margins_are_those_of_the_level_body_over_its_planned_feet(walk):
    setup, schedule = walk
    given = commanded(schedule, np.array([0, schedule.stop - 1]), setup.kinematics)
    assert given.margin[0] == pytest.approx(margin_at_rest(setup.kinematics, "12"))
    assert margin_at_rest(setup.kinematics, "1") < margin_at_rest(
        setup.kinematics, "12"
    )
    raised = setup.kinematics.stance(*(a[-1:] for a in schedule.angles()))
    margin = stability_margin(raised.feet, given.contact[1:], raised.center_of_mass)
    assert given.margin[1] == pytest.approx(margin[0])


def test_more_rows_than_are_geometries_at_once_are_all_judged():
    square = np.array([[1.0, 1], [-1, 1], [-1, -1], [1, -1]])
    count = BLOCK + 3
    points, contact = np.tile(square, (count, 1, 1)), np.ones((count, 4), bool)
    weight = np.zeros((count, 2))
    weight[-1] = [0.75, 0.0]
    margin = stability_margin(points, contact, weight)
    assert margin[:-1] == pytest.approx(np.ones(count - 1))
    assert margin[-1] == pytest.approx(0.25)


def test_without_a_foot_in_contact_the_nearest_carries():
    points = np.array([[[0.0, 0], [3, 0], [9, 9]]] * 2)
    contact = np.array([[False] * 3, [False, False, True]])
    found = carrying(points, contact, np.array([[2.0, 0, 1], [0.0, 0, 1]]))
    assert found.tolist() == [[False, True, False], [False, False, True]]
    every = np.ones((2, 3), bool)
    assert carrying(points, every, np.zeros((2, 3))) is every


def test_the_least_margin_is_found_between_states_that_are_computed():
    square = np.array([[1.0, 1], [-1, 1], [-1, -1], [1, -1]])
    points, contact = np.tile(square, (200, 1, 1)), np.ones((200, 4), bool)
    weight = np.zeros((200, 2))
    weight[130, 1] = -0.4
    least = LeastMargin()
    assert least.value == np.inf
    least.see(points, contact, weight)
    assert least.value == pytest.approx(0.6)
    feet = points.copy()
    feet[70] *= 0.3
    least.see(feet, contact, 0 * weight)
    assert least.value == pytest.approx(0.3)
