"""What the planner is asked for: the whole path at once, or its next segment."""

from __future__ import annotations

import numpy as np

from planner.paths import grid
from planner.plan import Plan, plan
from planner.replan import Step, plan_step
from sim.poses import nearest_turn
from sim.setup import Setup


def plan_open_loop(setup: Setup) -> Plan:
    """One plan for the whole path.

    Raises:
        PlannerError: If there is none, or it leaves the joint range.
    """
    return plan(
        setup.extended,
        setup.nominal(),
        setup.scenario.segments,
        stance=setup.stance,
        limits=setup.swing_limits,
    )


def plan_segment(
    setup: Setup, segment: int, pose: np.ndarray, swing: tuple[float, ...]
) -> Step:
    """Plan one segment from the pose reached to where the nominal path has it end.

    Args:
        setup: What to walk.
        segment: Its number, from 0.
        pose: Pose reached, in the start frame, shape (3,).
        swing: Angle of every group [rad].

    Raises:
        PlannerError: If the target cannot be approached from there.
    """
    nominal, segments = setup.nominal(), setup.scenario.segments
    target = nominal(grid(nominal, segments)[segment + 1])
    here = np.array([*pose[:2], nearest_turn(pose[2], to=target[2])])
    execution = setup.execution(finish=segment == segments - 1)
    return plan_step(setup.extended, setup.state(here, swing), target, execution)
