"""The forecast of a walk: its commands and predicted motion, before anything moves.

The forecast uses the prediction that the scenario steers on. For a walk that replans,
every segment is taken to end at its predicted pose; a segment that the joint range cuts
short is taken to reach its target nevertheless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models import TwistModel
from planner import Array, Plan
from planner.support import tick
from sim.experiments.predictions import twist_model
from sim.motion.prediction import Predictor, inspections
from sim.motion.schedule import Schedule
from sim.planning.open_loop import plan_open_loop, plan_segment, segment_target
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup


@dataclass(frozen=True)
class ForeseenStretch:
    """A stretch of commands and the motion predicted for it."""

    predictor: Predictor
    fraction: float = 1.0  # of its way; below 1 if the joint range cuts it short

    @property
    def schedule(self) -> Schedule:
        """The commands."""
        return self.predictor.schedule

    @cached_property
    def rows(self) -> Array:
        """Steps to inspect: the end of every phase, and even distances before it."""
        return inspections(self.schedule) - 1 - self.schedule.start

    def segment(self, rows: Array) -> Array:
        """Segment that determines the configuration at each step, shape (T,).

        Before the first swing of a segment it is the previous one, which left the legs
        in their present angles.
        """
        deciding, swung = [], -1
        for phase in self.schedule.phases:
            if phase.kind == "swing":
                swung = phase.segment
            deciding.append(max(phase.segment - (phase.segment != swung), 0))
        return np.array(deciding)[self.schedule.phase_of(rows)]


def foresee(setup: Setup, planned: Plan | None = None) -> list[ForeseenStretch]:
    """The stretches of a walk in time order: one open loop, or one for each segment.

    The open loop is planned here unless its plan is given.
    """
    twists = twist_model(setup, setup.scenario.steered_on)
    if setup.scenario.replan:
        return list(_replanned(setup, twists))
    schedule = scheduled(setup, (planned or plan_open_loop(setup)).segments())
    predictor = Predictor(schedule, twists, setup.kinematics)
    return [ForeseenStretch(predictor)] if schedule.phases else []


def _replanned(setup: Setup, twists: TwistModel) -> Iterator[ForeseenStretch]:
    shape, pose = setup.at_rest, np.zeros(3)
    for segment in range(setup.scenario.segments):
        tick()
        step = plan_segment(setup, segment, pose, shape.swing)
        schedule = scheduled(setup, step.plan.segments(), shape, segment)
        predictor = Predictor(schedule, twists, setup.kinematics, tuple(pose))
        shape = schedule.end
        if schedule.phases:
            pose = predictor(np.array([schedule.stop - schedule.start - 1])).pose[0]
            yield ForeseenStretch(predictor, step.fraction)
        if step.fraction < 1:
            pose = segment_target(setup, segment)
