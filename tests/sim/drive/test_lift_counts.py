"""Lift joints on counts: standing feet keep their load, and none of them bounces."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.library import load
from planner.systems.flows import Flow
from sim.drive.drive import Drive
from sim.drive.lift_counts import LiftCounts, lift_torques
from sim.drive.rehearsal import Rehearsal
from sim.motion.schedule import Scheduler
from sim.preparation.setup import prepare
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from tests.walks import simulated

PASSED = 2.0  # counts above the floor that a foot passes in a single command


def classroom(**changes):
    given = {"name": "short", "robot": "hexapod-classroom", "segments": 1}
    return Scenario(**given | {"path": line((0.0075, 0.0075, 0.0))} | changes)


@pytest.fixture(scope="module")
def setup():
    return prepare(classroom())


@pytest.fixture(scope="module")
def lifted(setup):
    """How far both groups are raised over a few steps, and counts of all lift joints.

    Joints would lag behind by up to half a count, to and fro.
    """
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(0.2)
    for stratum, field in (("1", "g1_1"), ("2", "g2_2"), ("1", "g1_1")):
        swings = setup.equations.swings[field]
        scheduler.flow(Flow(stratum, field, 0.1), swings)
    scheduler.enter("12")
    _, lift = scheduler.finish().angles()
    lag = np.random.default_rng(1).uniform(-0.004, 0.004, (len(lift), 6))
    return lift, LiftCounts(setup, feed_forward=True).at(lift, lag)


def test_a_standing_leg_keeps_one_count_for_as_long_as_the_same_feet_stand(
    setup, lifted
):
    lift, counts = lifted
    settled = ((lift < 1e-12) | (lift > 0.2)).all(axis=1)
    down, counts = (lift < 1e-12)[settled][:, setup.robot.group_of_leg], counts[settled]
    for feet in np.unique(down, axis=0):
        rows = (down == feet).all(axis=1)
        assert (counts[rows][:, feet] == counts[rows][0, feet]).all()


def test_between_two_commands_there_are_no_counts(setup):
    """As where a robot stands for less than the time from one to the next."""
    counts = LiftCounts(setup, feed_forward=True)
    assert counts.at(np.zeros((0, 2)), np.zeros((0, 6))).shape == (0, 6)


def test_a_foot_passes_the_heights_at_which_it_may_touch_in_one_command(setup, lifted):
    lift, counts = lifted
    raised = lift[:, setup.robot.group_of_leg]
    for leg in range(6):
        ground = counts[raised[:, leg] < 1e-12, leg].max()
        above = np.unique(counts[:, leg] - ground)
        assert not ((above > 0) & (above < PASSED - 1)).any()
        assert len(above) > 10  # and it is raised in many counts all the same


def test_the_body_stands_at_a_height_where_no_standing_leg_changes_its_count(setup):
    lift_counts = LiftCounts(setup, feed_forward=True)
    lift = np.array([[0.0, 0.0], [0.0, 0.3], [0.3, 0.0]])
    counts = lift_counts.at(lift, np.zeros((3, 6)))
    standing = lift[:, setup.robot.group_of_leg] == 0
    assert len(np.unique(counts[standing])) == 1
    # although loads bend them by 0.4 counts on six feet, and by up to 1.2 on three
    torques = [lift_torques(setup, feet) for feet in standing]
    bent = np.concatenate([t[f] for t, f in zip(torques, standing, strict=True)])
    assert np.ptp(bent / (9.17 * setup.servo.resolution)) > 0.7


def test_counts_that_are_fine_are_the_commands_without_counts():
    fine, plain = (prepare(classroom(resolution=r)) for r in (1e-6, 0.0))
    scheduler = Scheduler(fine.limits, fine.at_rest)
    scheduler.hold(0.3)
    scheduler.flow(Flow("1", "g1_1", 0.1), fine.equations.swings["g1_1"])
    scheduler.enter("12")
    schedule = scheduler.finish()
    torques = Rehearsal(fine).torques(schedule)
    on_counts, without = (
        np.concatenate(list(Drive(setup).commands(schedule, torques)))
        for setup in (fine, plain)
    )
    # half a count, from joint zero and from rest; statics alone were 5e-3 rad off
    assert np.abs(on_counts - without).max() <= 2e-6


def test_counts_are_fine_where_the_least_load_bends_its_leg_by_two_of_them(setup):
    bent = LiftCounts(setup, feed_forward=True).least_bent
    assert bent == pytest.approx(0.86, abs=0.01)
    for counts, fine in ((1.9, False), (2.1, True)):
        resolution = setup.servo.resolution * bent / counts
        finer = prepare(classroom(resolution=resolution))
        assert LiftCounts(finer, feed_forward=True).fine is fine
    assert not LiftCounts(finer, feed_forward=False).fine  # nothing to follow


@pytest.mark.physics
@pytest.mark.parametrize("name", ["hexapod", "hexapod-classroom"])
def test_statics_on_three_feet_are_those_of_the_physics(name):
    # friction holds feet apart as they came to stand, which bears on lift joints too
    setup = prepare(classroom(robot=name, servo="ideal", friction=0.0))
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.enter("1")
    scheduler.hold(1.0)
    borne = Rehearsal(setup).torques(scheduler.finish()).values[-1]
    joints = [setup.model.actuator(j).id for j in setup.robot.lift_joints]
    found = lift_torques(setup, setup.robot.planted("1"))
    # what joints bend under the load, a thousandth of a radian; measured 0.2 %
    assert found == pytest.approx(borne[joints], abs=0.01 * np.abs(found).max())


@pytest.mark.physics
def test_the_classroom_robot_walks_on_its_own_servos_without_a_bounce():
    summary = simulated(classroom()).summary
    assert summary["servo"]["name"] == "mg90"
    assert summary["bounces"] == 0  # 4 with each joint's feed-forward rounded by itself
    assert summary["achieved"]["min_margin"] > 0.03
    assert load("hexapod-classroom").card.servo.made == "mg90"


def test_joints_stand_at_as_many_counts_as_their_angles_hold():
    robot = SimpleNamespace(
        lift_joints=("a", "b"), standing_angle={"a": 0.03, "b": -0.1}.get
    )
    setup = SimpleNamespace(robot=robot, servo=SimpleNamespace(resolution=0.02))
    standing = LiftCounts._standing.func(SimpleNamespace(setup=setup))
    assert standing == pytest.approx([1.5, -5.0])


@pytest.mark.parametrize(("off", "trusted"), [(1.9, False), (2.1, True)])
def test_a_rehearsal_is_trusted_that_is_two_counts_off_what_statics_say(off, trusted):
    counts = SimpleNamespace(
        setup=SimpleNamespace(
            robot=SimpleNamespace(raise_sign=1.0, group_of_leg=np.zeros(1, dtype=int)),
            servo=SimpleNamespace(resolution=0.1),
        ),
        _bent=lambda groups: np.array([3.0]),
        _standing=np.array([100.0]),
        height=0.0,
    )
    zero, rehearsed = np.zeros((1, 1)), np.array([[0.1 * (3.0 + off)]])
    found = LiftCounts.at(counts, zero, zero, rehearsed)
    assert found == round(103.0 + off * trusted)
