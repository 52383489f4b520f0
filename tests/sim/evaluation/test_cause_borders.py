"""Causes of walks that went wrong, and what is counted of walks."""

from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy import nan

from sim.evaluation import causes
from sim.evaluation.causes import Evidence, likely_cause
from sim.evaluation.deviations import sensed
from sim.evaluation.phases import (
    carried_out,
    commanded_pace,
    count_changes,
    moving_time,
    real_robot,
    swing_travel,
)
from sim.evaluation.verdict import judge
from sim.logs.alignment import Measured
from sim.logs.log import Log
from sim.physics.measure import ContactLog
from sim.scenarios.file import load_scenario
from tests.sim.evaluation.test_causes import with_recording, with_settings, with_setup
from tests.walks import simulated


@pytest.fixture(scope="module")
def evidence():
    """A walk of 10 mm on which nothing is wrong."""
    short = {"path.goal": [0.01, 0.0, 0.0], "segments": 1}
    found = simulated(load_scenario("line", short)).evaluation
    return Evidence(found.walk, found.achieved, found.predicted, found.weighed)


@pytest.mark.parametrize(("count", "told"), [(2, False), (3, True)])
def test_two_bounces_of_a_walk_that_arrived_are_harmless(count, told, monkeypatch):
    monkeypatch.setattr(causes, "_coarse", lambda evidence: "why")
    scenario = SimpleNamespace(is_imperfect=False)
    recording = SimpleNamespace(bounces=count)
    walk = SimpleNamespace(
        recording=recording, setup=SimpleNamespace(scenario=scenario)
    )
    assert bool(causes._bounced(SimpleNamespace(walk=walk))) == told


def verdict(evidence):
    return judge(evidence, evidence.walking)


@pytest.mark.parametrize(
    ("own", "walls", "said"),
    [
        (1, 0, "parts of the robot touched each other 1 time;"),
        (2, 0, "parts of the robot touched each other 2 times;"),
        (0, 1, "the robot touched obstacles 1 time;"),
        (3, 4, "touched each other 3 times and the robot touched obstacles 4 times;"),
    ],
)
def test_whatever_touches_is_counted(evidence, own, walls, said):
    touched = with_recording(evidence, self_contacts=own, wall_contacts=walls)
    found = verdict(touched)
    assert found.word == "collided"
    assert said in found.text


def bouncing(evidence, per_landing):
    landings = 3 * sum(p.kind == "land" for p in evidence.walk.phases)
    bounces = np.zeros(6, dtype=int)
    bounces[2] = round(per_landing * landings)
    return with_recording(evidence, bounces_of=bounces)


@pytest.mark.parametrize(("each", "told"), [(5.0, False), (5.2, True)])
def test_five_bounces_a_touchdown_are_a_cause(evidence, each, told):
    assert ("bounced" in likely_cause("drifted", bouncing(evidence, each))) == told


@pytest.mark.parametrize(("share", "light"), [(0.19, True), (0.21, False)])
def test_joints_of_a_fifth_of_a_motors_inertia_are_light(evidence, share, light):
    from sim.world.motors import inertia_share

    robot, model = evidence.walk.setup.robot, copy(evidence.walk.setup.model)
    leg = robot.leg_cards[2]
    own = inertia_share(robot, model, (leg.swing, leg.lift))
    model.dof_M0[:] *= share / own
    said = likely_cause("drifted", with_setup(bouncing(evidence, 9.0), model=model))
    assert (f"{100 * share:.0f} % of the inertia of a motor" in said) == light
    assert ("too stiff" in said) != light


@pytest.mark.parametrize(("part", "told"), [(0.0095, False), (0.0105, True)])
def test_a_servo_at_its_limit_in_a_hundredth_of_all_steps_is_named(
    evidence, part, told
):
    limited = np.zeros(evidence.walk.setup.model.nu)
    limited[3] = part * evidence.walk.steps
    found = likely_cause("fell", with_recording(evidence, limited=limited))
    assert ("gave all its" in found) == told


@pytest.mark.parametrize(("bent", "told"), [(0.029, False), (0.031, True)])
def test_servos_that_lag_by_30_mrad_on_average_are_soft(evidence, bent, told):
    model, moments = evidence.walk.setup.model, evidence.walk.recording.moments
    place = model.joint("lift_6").qposadr[0]
    qpos, walking = moments.qpos.copy(), evidence.walking
    ctrl = np.concatenate(list(evidence.walk.commands()))[moments.step[walking] - 1]
    qpos[walking, place] = ctrl[:, evidence.drives["lift_6"]] + bent * (
        -1
    ) ** np.arange(walking.sum())
    changed = with_recording(evidence, moments=moments._replace(qpos=qpos))
    said = likely_cause("drifted", changed)
    assert ("'lift_6'" in said) == told
    assert (f"is {1e3 * bent:.0f} mrad off" in said) == told


@pytest.mark.parametrize(("share", "told"), [(0.04, True), (0.06, False)])
def test_a_foot_that_carries_in_a_twentieth_of_its_time_never_does(
    evidence, share, told
):
    contact, walking = evidence.achieved.contact.copy(), evidence.walking
    planned = np.flatnonzero(evidence.best.contact[:, 4] & walking)
    contact[:, 4] = False
    contact[planned[: round(share * len(planned))], 4] = True
    changed = replace(evidence, achieved=replace(evidence.achieved, contact=contact))
    assert ("leg 5 never carried" in likely_cause("fell", changed)) == told


@pytest.mark.parametrize(("used", "told"), [(0.49, False), (0.51, True)])
def test_a_slope_that_takes_half_of_the_friction_is_steep(evidence, used, told):
    steep = with_settings(
        evidence, slope=(float(np.arctan(used * 0.4)), 0.0), friction=0.4
    )
    said = likely_cause("drifted", steep)
    assert (f"takes {100 * used:.0f} % of the friction" in said) == told


@pytest.mark.parametrize(("used", "told"), [(0.49, False), (0.51, True)])
def test_strokes_that_take_half_of_what_friction_holds_are_hasty(evidence, used, told):
    rates = np.linalg.norm(evidence.walk.setup.kinematics.standing.rates, axis=-1)
    held = evidence.walk.setup.scenario.friction * 9.81
    hasty = with_settings(evidence, swing_acceleration=used * held / float(rates.max()))
    assert ("swing_acceleration" in likely_cause("slipped", hasty)) == told


def test_lifts_swings_and_times_of_a_walk_are_counted(evidence):
    walk = evidence.walk
    switches, fastest = commanded_pace(walk)
    kinds = [p.kind for p in walk.phases]
    assert switches == kinds.count("lift") + kinds.count("land")
    assert count_changes(walk) == switches
    moving = [p for p in walk.phases if p.kind != "hold"]
    dt = walk.setup.limits.timestep
    assert moving_time(walk) == pytest.approx((moving[-1].stop - moving[0].start) * dt)
    swings = [p for p in walk.phases if p.kind == "swing"]
    groups = walk.setup.robot.groups
    loaded, free = (swing_travel(swings, groups, loaded=way) for way in (True, False))
    whole = sum(abs(p.amount) * sum(map(abs, p.direction)) for p in swings)
    assert loaded + free == pytest.approx(whole)
    assert 0 < loaded < whole
    peaks, schedule = [], walk.stretches[-1].schedule
    for phase in swings:  # by the commands themselves
        rows = np.arange(phase.start, phase.stop) - schedule.start
        swing, _ = schedule.angles(rows)
        peaks.append(np.abs(np.diff(swing, axis=0)).max() / dt)
    assert fastest == pytest.approx(max(peaks), rel=1e-2)
    told = carried_out(walk)
    assert [p.kind for p in told] == kinds
    assert told[-1].end == pytest.approx(walk.phases[-1].stop * dt)


def test_a_group_changes_when_its_last_foot_does(evidence):
    walk, own = evidence.walk, evidence.walk.setup.robot.group_of_leg == 0
    rows = np.ones((7, 6), dtype=bool)
    rows[1, np.flatnonzero(own)[0]] = False  # one foot alone is no lift-off
    rows[3:5, own] = False
    rows[5, np.flatnonzero(own)[0]] = False
    assert count_changes(walk, rows) == 2
    log = ContactLog(walk.starts + np.arange(7), rows)
    seen = replace(walk, recording=replace(walk.recording, contacts=log))
    assert count_changes(seen) == 2


def test_what_feedback_thinks_is_told_if_it_was_told_something(evidence):
    assert sensed(evidence.walk) is None
    exact = SimpleNamespace(
        feedback=SimpleNamespace(sensing=SimpleNamespace(is_exact=True))
    )
    assert sensed(SimpleNamespace(followed=exact)) is None
    stop = SimpleNamespace(expected=(0.3, 0.4, 3.1), true=(0.0, 0.0, -3.1))
    sensing = SimpleNamespace(is_exact=False, sees_position=True)
    followed = SimpleNamespace(
        feedback=SimpleNamespace(sensing=sensing), stops=[stop],
        claimed=(0.01, 0.02), bound=(0.003, 0.004),
    )  # fmt: skip
    found = sensed(SimpleNamespace(followed=followed))
    assert found.wrong == pytest.approx(0.5)
    assert found.wrong_yaw == pytest.approx(2 * np.pi - 6.2)
    assert (found.claimed, found.claimed_yaw) == (0.01, 0.02)
    assert (found.bound, found.bound_yaw) == (0.003, 0.004)
    assert found.thought == [0.3, 0.4, 3.1]


def test_a_plan_without_a_goal_that_ends_beside_it_is_to_blame_on_paper(monkeypatch):
    """Whatever it misses, where the walk itself was not weighed."""
    setup = SimpleNamespace(
        scenario=SimpleNamespace(replan=False, steer="ideal", fields="own", segments=4),
        robot=SimpleNamespace(card=SimpleNamespace(groups={})),
    )
    weighed = SimpleNamespace(goal=None, prediction="ideal")
    walk = SimpleNamespace(setup=setup)
    for share in (0.3, 0.0):
        found = SimpleNamespace(
            walk=walk, weighed=weighed, predicted={}, on_paper=lambda _, s=share: s
        )
        monkeypatch.setattr(causes, "say", lambda *_, **facts: f"{facts['percent']:g}")
        assert causes._on_paper(found) == ("30" if share else "")


def test_a_real_robot_is_told_by_its_last_row():
    """Of its trials' spread as of its pose."""
    rows = np.arange(9.0).reshape(3, 3)
    motion = SimpleNamespace(log=SimpleNamespace(
        duration=1.0, measured=None, contact={}, done=("counted",)
    ))  # fmt: skip
    moments = SimpleNamespace(step=np.array([0, 10]), qpos=np.zeros((2, 7)))
    moments.qpos[:, 3] = 1.0
    setup = SimpleNamespace(
        motion=motion, model=None, limits=SimpleNamespace(timestep=0.1),
        robot=SimpleNamespace(root_address_in=lambda _: 0),
    )  # fmt: skip
    recording = SimpleNamespace(moments=moments)
    walk = SimpleNamespace(setup=setup, recording=recording, starts=0)
    for spread in (rows + 10, None):
        found = real_robot(walk, Measured(pose=rows, spread=spread, done=("turned",)))
        assert found.pose == [6.0, 7.0, 8.0]
        assert found.spread == (None if spread is None else [16.0, 17.0, 18.0])
        assert found.done == ["counted", "turned"]
    motion.log.time, moments.contact = np.array([0.0, 0.5, 1.0]), np.ones((2, 2), bool)
    setup.robot.legs = (3, 8)
    for column, share in ([1, 9, nan], 1.0), ([nan, 9, nan], None), ([0, 9, 1], 0.5):
        motion.log.contact = {8: np.array(column)}
        assert real_robot(walk, Measured()).contact == share


def test_joints_are_compared_from_their_first_measured_angle_to_their_last(monkeypatch):
    time = np.array([0.0, 0.5, 1.0])
    turned = lambda *_: np.array([[0.0], [0.1], [0.2], [0.3], [0.4]])  # noqa: E731
    monkeypatch.setattr("sim.evaluation.phases.turned", turned)
    moments = SimpleNamespace(step=np.arange(5), qpos=np.eye(5, 7, 3))
    setup = SimpleNamespace(
        model=None, limits=SimpleNamespace(timestep=0.25),
        robot=SimpleNamespace(root_address_in=lambda _: 0),
    )  # fmt: skip
    walk = SimpleNamespace(setup=setup, recording=SimpleNamespace(moments=moments))
    walk.starts = 0
    for column, off in (
        ([nan, 0.3, 0.5], 0.1),
        ([0.0, nan, nan], 0.0),
        ([nan] * 3, None),
    ):
        measured = np.array(column)[:, None]
        log = Log(time, ("a",), np.zeros((3, 1)), measured=measured)
        setup.motion = SimpleNamespace(log=log)
        found = real_robot(walk, Measured()).joints
        assert found == (None if off is None else pytest.approx(off, abs=1e-12))
