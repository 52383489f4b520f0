"""All segments of a walk, each planned from the state that the kinematics reached."""

from __future__ import annotations

from collections.abc import Sequence

from planner import Flow, rollout
from sim.motion.schedule import LegState
from sim.planning.open_loop import plan_segment
from sim.planning.soundness import require_sound_flows
from sim.preparation.setup import Setup


def replanned(setup: Setup) -> Sequence[Flow]:
    """The flows of all segments, on the exact kinematics.

    Args:
        setup: What to walk.

    Raises:
        PlannerError: If a target cannot be approached.
        SimulationError: If the robot tips over or its legs collide on the way.
    """
    groups = len(setup.robot.groups)
    state = setup.nominal()(0.0)
    flows: list[Flow] = []
    for segment in range(setup.scenario.segments):
        pose, swing = state[:3], tuple(state[3 : 3 + groups])
        step = plan_segment(setup, segment, pose, swing)
        legs = LegState(swing, setup.robot.card.bottom)
        require_sound_flows(setup, step.plan.segments(), legs)
        state = rollout(step.plan)[-1]
        flows += step.plan.flows
    return flows
