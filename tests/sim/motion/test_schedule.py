"""Smooth joint commands from flows."""

from dataclasses import replace

import numpy as np
import pytest

from planner.systems.flows import Flow
from sim.motion.schedule import LegState, MotionLimits, Scheduler, ramp

LIMITS = MotionLimits(
    swing_speed=0.5,
    swing_acceleration=5.0,
    lift_angle=0.3,
    lift_time=0.2,
    hold=0.5,
    timestep=0.001,
    groups=("1", "2"),
)
UNIT = ((1.0, 0.0), (0.0, 1.0))
STANDING = LegState((0.0, 0.0), "12")


def scheduled(*flows):
    scheduler = Scheduler(LIMITS, STANDING)
    scheduler.hold(0.1)
    for stratum, group, amount in flows:
        scheduler.flow(Flow(stratum, f"g{stratum}_{group + 1}", amount), UNIT[group])
    scheduler.enter("12")
    return scheduler.finish()


WALK = scheduled(("1", 0, 0.2), ("1", 1, -0.1), ("2", 1, 0.003), ("2", 0, -0.4))


@pytest.mark.parametrize("amount", [1e-6, 0.003, 0.05, 0.4, -0.4, 3.0])
@pytest.mark.parametrize("timestep", [0.002, 0.0005])
def test_a_swing_keeps_its_speed_and_acceleration_bounds(amount, timestep):
    limits = replace(LIMITS, timestep=timestep)
    steps, rise = limits.swing_steps((1.0, 0.0), amount)
    way = ramp(np.arange(1, steps + 1), steps, rise)
    angle = np.concatenate([[0, 0], amount * way, [amount]])
    speed = np.diff(angle) / timestep
    assert angle[-1] == amount
    assert np.abs(speed).max() <= 0.5 * (1 + 1e-9)
    # differences of speed over a step average the acceleration: never above its peak
    assert np.abs(np.diff(speed)).max() / timestep <= 5.0 * (1 + 1e-9)
    assert (np.sign(amount) * speed >= 0).all()


@pytest.mark.parametrize("gains", [(2.0, 1.0), (0.5, 1.0)])
def test_the_bounds_are_of_the_joint_that_swings_farthest(gains):
    """Its leg may swing farther than its group, or less far."""
    own, of_joint = replace(LIMITS, gains=gains), 0.4 * gains[0]
    assert own.swing_steps((1.0, 0.0), 0.4) == LIMITS.swing_steps((1.0, 0.0), of_joint)
    assert own.swing_peak((1.0, 0.0), 3.0) == pytest.approx(0.5, rel=1e-2)


def test_a_long_swing_uses_the_speed_it_is_given():
    steps, _ = LIMITS.swing_steps((1.0, 0.0), 3.0)
    # 3 rad at 0.5 rad/s, and one rise of 1.5 * 0.5 / 5 s for starting and stopping
    assert steps * 0.001 == pytest.approx(3.0 / 0.5 + 0.15, abs=0.002)


def test_commands_are_continuous_and_end_where_the_flows_say():
    swing, lift = WALK.angles()
    assert len(swing) == WALK.stop
    assert swing[-1] == pytest.approx([0.2 - 0.4, -0.1 + 0.003], abs=1e-15)
    assert WALK.end.swing == pytest.approx(tuple(swing[-1]))
    assert np.abs(np.diff(swing, axis=0)).max() <= 0.5 * 0.001 * (1 + 1e-9)
    # a lift covers its angle in 0.2 s: twice the mean speed at its peak
    assert np.abs(np.diff(lift, axis=0)).max() <= 2 * 0.3 / 0.2 * 0.001 * (1 + 1e-9)


def test_only_one_group_moves_at_a_time():
    swing, lift = (np.abs(np.diff(angle, axis=0)) > 0 for angle in WALK.angles())
    assert (swing.sum(axis=1) + lift.sum(axis=1)).max() == 1


def test_a_group_lands_before_another_lifts():
    _, lift = WALK.angles()
    assert (lift > 0).sum(axis=1).max() == 1


def test_loaded_and_lifted_groups_are_those_of_the_stratum_while_a_group_swings():
    _, lift = WALK.angles()
    for phase in WALK.phases:
        if phase.kind == "swing":
            raised = lift[phase.start : phase.stop] == LIMITS.lift_angle
            expected = [group not in phase.stratum for group in LIMITS.groups]
            assert (raised == expected).all()


def test_phases_follow_each_other_without_gaps():
    assert [p.start for p in WALK.phases[1:]] == [p.stop for p in WALK.phases[:-1]]
    kinds = [p.kind for p in WALK.phases]
    assert kinds == [
        "hold", "lift", "swing", "swing", "land", "lift", "swing", "swing", "land",
    ]  # fmt: skip


def test_a_group_that_lifts_or_lands_is_no_support_while_it_does():
    found = [(p.kind, p.moving, p.stratum) for p in WALK.phases if p.kind != "swing"]
    assert found == [
        ("hold", (), "12"),
        ("lift", (1,), "1"),
        ("land", (1,), "1"),
        ("lift", (0,), "2"),
        ("land", (0,), "2"),
    ]
    assert WALK.end.stratum == "12"


def test_a_schedule_can_continue_where_another_ended():
    scheduler = Scheduler(LIMITS, WALK.end, step=WALK.stop, segment=3)
    scheduler.flow(Flow("1", "g1_1", 0.2), UNIT[0])
    more = scheduler.finish()
    swing, lift = more.angles()
    assert more.start == WALK.stop
    assert swing[0] == pytest.approx(WALK.angles()[0][-1])
    assert swing[-1, 0] == pytest.approx(0.0, abs=1e-15)
    assert lift[-1, 1] == LIMITS.lift_angle
    assert {phase.segment for phase in more.phases} == {3}
