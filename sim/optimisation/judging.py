"""Properties of a plan as a schedule: its duration, and its predicted end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models import TwistModel
from planner import Array, Flow, Plan, contact_switches
from planner.execution import stepped
from sim.experiments.predictions import twist_model
from sim.motion.poses import PathDeviation, path_deviation
from sim.motion.prediction import Predictor, inspections
from sim.motion.schedule import Schedule
from sim.obstacles.clearance import surroundings
from sim.planning.bounds import ClearanceBound
from sim.planning.forecast import ForeseenStretch
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup
from sim.scenarios.predictions import IDEAL, QUASI_STATIC


def real_prediction(setup: Setup) -> str:
    """The prediction that optimised plans follow: quasi-static, or as identified."""
    key = setup.scenario.steered_on
    return QUASI_STATIC.key if key == IDEAL.key else key


def real_twists(setup: Setup) -> TwistModel:
    """The body twists of that prediction."""
    return twist_model(setup, real_prediction(setup))


def least_clearance(setup: Setup) -> float | None:
    """The clearance that a scenario asks for [m]; None if there is nothing to keep."""
    least = setup.scenario.min_clearance
    return least if setup.scenario.obstacles and least >= 0 else None


@dataclass(frozen=True)
class Judge:
    """Judges flows of one setup.

    Example:
        >>> from sim import Judge, ScenarioProblem, load_scenario, prepare
        >>> setup = prepare(load_scenario("line", {"path.goal": [0.1, 0.0, 0.0]}))
        >>> plan = ScenarioProblem.ready(setup).solve().plan
        >>> Judge(setup).end(plan.flows)[:3].round(3)
        array([0.1, 0. , 0. ])
    """

    setup: Setup

    def worth(self, plan: Plan) -> float:
        """What the scenario wants to be least, of a whole plan."""
        objective = self.setup.scenario.optimise
        duration = self.duration(plan.flows)
        if objective == "switches":
            return contact_switches(plan.system, plan.flows) + 1e-6 * duration
        if objective == "time":
            return duration
        groups, swings = self.setup.robot.groups, self.setup.equations.swings
        return sum(  # the way of the loaded groups' angles [rad]
            abs(flow.duration * share)
            for flow in plan.flows
            for group, share in zip(groups, swings[flow.field], strict=True)
            if group in flow.stratum
        )

    def duration(self, flows: Sequence[Flow]) -> float:
        """Time from the first lift-off to the last touchdown [s]."""
        return self.schedule([flows]).stop * self.setup.limits.timestep

    def end(self, flows: Sequence[Flow]) -> Array:
        """State predicted after the flows, shape (n,)."""
        schedule, pose = self.schedule([flows]), np.zeros(3)
        if schedule.phases:
            predictor = self._predictor(schedule)
            pose = predictor(np.array([schedule.stop - 1])).pose[0]
        return self.setup.state(pose, schedule.end.swing)

    def stepped(self, segments: Sequence[Sequence[Flow]]) -> list[list[Flow]]:
        """Flows with legs set anew before every stroke."""
        setup, rest = self.setup, self.setup.state(np.zeros(3))
        rules = setup.equations.limits, setup.equations.static_stability
        return stepped(setup.extended.shape, segments, rest, rest, *rules)

    def poses(self, plan: Plan) -> Array:
        """Poses predicted along a plan, shape (T, 3), the start first."""
        schedule = self.schedule(list(plan.segments()))
        if not schedule.phases:
            return np.zeros((1, 3))
        rows = inspections(schedule) - 1
        return np.vstack([np.zeros(3), self._predictor(schedule)(rows).pose])

    def deviation(self, plan: Plan) -> PathDeviation:
        """Farthest from the path [m] and from its yaw [rad], as it is predicted."""
        return path_deviation(self.setup.scenario.path.curve, self.poses(plan))

    def margin_lack(self, segments: Sequence[Sequence[Flow]]) -> float:
        """What the least predicted margin lacks to the scenario's [m]; at least 0."""
        least, schedule = self.setup.scenario.min_margin, self.schedule(segments)
        if least is None or not schedule.phases:
            return 0.0
        margin = self._predictor(schedule)(inspections(schedule) - 1).margin
        return max(0.0, least - float(margin.min()))

    def clearance_lack(self, segments: Sequence[Sequence[Flow]]) -> float:
        """What the least predicted clearance lacks to the one asked for [m], if any."""
        least, schedule = least_clearance(self.setup), self.schedule(segments)
        if least is None or not schedule.phases:
            return 0.0
        bound = ClearanceBound(surroundings(self.setup), least)
        stretch = ForeseenStretch(self._predictor(schedule))
        return max(0.0, least - bound.least_of(stretch))

    def schedule(self, segments: Sequence[Sequence[Flow]]) -> Schedule:
        """The commands of flows, without holds."""
        return scheduled(self.setup, segments)

    def _predictor(self, schedule: Schedule) -> Predictor:
        return Predictor(schedule, real_twists(self.setup), self.setup.kinematics)
