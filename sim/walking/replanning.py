"""Walks that are planned on the way, each segment from the pose that is reached.

A robot that is not as it should be misses every segment by much the same: its feet are
not where they should be, its floor leans. Planning from the pose makes good what was
missed, one segment late. What is likely to be missed can be allowed for beforehand; for
that, all segments bring the legs back to angle 0, as otherwise only the last one does.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from planner import Array
from planner.planning import Step
from sim.experiments.predictions import twist_model
from sim.motion.poses import seen_from
from sim.motion.schedule import LegState
from sim.planning.aiming import segment_ends
from sim.planning.open_loop import plan_segment
from sim.planning.soundness import require_sound_flows
from sim.preparation.setup import Setup

if TYPE_CHECKING:
    from sim.walking.walker import Walker

LEARNED = 0.5  # of what a segment misses more than expected; halves it every segment


def replanned(walker: Walker) -> int:
    """Walk segment by segment, with all feet down in between.

    Args:
        walker: A walker that stands.

    Returns:
        How many segments were scaled down to the joint range.

    Raises:
        PlannerError: If a segment cannot be planned from where the robot has come to.
        SimulationError: If the physics diverges.
        UsageError: If the walk takes more steps or memory than there can be.
    """
    setup, saturated = walker.setup, 0
    missing = np.zeros(3) if setup.learns else None
    for segment in range(setup.scenario.segments):
        began, pose, swing = time.perf_counter(), walker.pose, walker.swing
        step = plan_segment(setup, segment, pose, swing, missing)
        walker.seconds["plan"] += time.perf_counter() - began
        saturated += step.fraction < 1
        legs = LegState(swing, setup.robot.card.bottom)
        require_sound_flows(setup, step.plan.segments(), legs)
        walker.go(list(step.plan.segments()), first=segment)
        if missing is not None:
            missed = _missed(setup, step, swing, seen_from(pose, walker.pose))
            missing = missing + LEARNED * (missed - missing)
    return saturated


def _missed(setup: Setup, step: Step, swing: tuple[float, ...], walked: Array) -> Array:
    """Where a segment ended, less where it was predicted to, shape (3,)."""
    twists = twist_model(setup, setup.scenario.steered_on)
    missed: Array = walked - segment_ends(setup, step.plan, twists, swing)[-1]
    return missed
