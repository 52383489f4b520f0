"""The task that a scenario gives to the optimiser, and the judge of its plans.

The strokes move the body as the real contacts do, and time is that of the schedule. The
path is followed as closely as the scenario demands, or as closely as its stratified
plan follows it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf, pi

import numpy as np

from models import Equations, TwistModel
from models.motion import contact_equations, contact_fields
from planner import Array, Flow, Plan, contact_switches
from planner.execution import stepped
from planner.optimisation import (
    CHEAP,
    Criterion,
    Expression,
    Inequality,
    Stage,
    Task,
    Tolerance,
    cycle,
)
from sim.experiments.identification import twist_model
from sim.motion.poses import PathDeviation, path_deviation
from sim.motion.prediction import Predictor, inspections
from sim.motion.schedule import Schedule
from sim.obstacles.clearance import surroundings
from sim.planning.bounds import ClearanceBound, ForeseenStretch
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup
from sim.scenarios.predictions import IDEAL, QUASI_STATIC

RANGE_ROOM = 1e-4  # [rad] kept from the ends of the joint range, for servos
ROUGH = 1e-6  # [m/rad], [rad/rad] of fields; the aim makes up for what they leave out
INNER_ROOM = 1e-4  # [m] of margin and clearance, kept between the ends of strokes


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
            pose = self._predictor(schedule)(np.array([schedule.stop - 1])).pose[0]
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
        return max(0.0, least - float(bound.swept(stretch).min()))

    def schedule(self, segments: Sequence[Sequence[Flow]]) -> Schedule:
        """The commands of flows, without holds."""
        return scheduled(self.setup, segments)

    def _predictor(self, schedule: Schedule) -> Predictor:
        return Predictor(schedule, real_twists(self.setup), self.setup.kinematics)


def real_equations(setup: Setup) -> Equations:
    """The robot's equations with the strokes that its plans use as they really are."""
    return _equations(setup, real_prediction(setup))


@lru_cache(maxsize=4)
def _equations(setup: Setup, prediction: str) -> Equations:
    described = setup.equations
    used = [e for e in described.elements if e in described.swings]
    groups, twists = setup.robot.groups, twist_model(setup, prediction)
    fields = contact_fields(described, groups, twists, used, ROUGH)
    return contact_equations(described, fields)


def task_of(setup: Setup, within: tuple[float, float]) -> Task:
    """Fields, stages, margin and clearance to keep, within deviations [m] and [rad]."""
    scenario, described = setup.scenario, real_equations(setup)
    system = described.system
    names = [str(symbol) for symbol in system.state]
    pace = {
        name: setup.limits.farthest(direction, 1.0) / setup.limits.swing_speed
        for name, direction in described.swings.items()
    }
    stages = cycle(system, described.elements)
    recoveries = {r.field for stage in stages for r in stage.recoveries}
    cheap = CHEAP if scenario.optimise == "strokes" else 1.0
    yaw = within[1] if within[1] < pi else inf
    return Task(
        system=system,
        stages=stages,
        tolerances=(Tolerance((0, 1), within[0]), Tolerance((2,), yaw)),
        limits={
            names.index(name): (low + RANGE_ROOM, high - RANGE_ROOM)
            for name, (low, high) in described.limits.items()
        },
        price={
            name: p * (cheap if name in recoveries else 1.0) for name, p in pace.items()
        },
        overlapped=scenario.overlap_recovery,
        centred=described.stance == "stepped",
        inequalities=tuple(_inequalities(setup, within[0])),
    )


def criterion_of(setup: Setup) -> Criterion:
    """What is to be least, and how flows are measured."""
    objective, judge = setup.scenario.optimise, Judge(setup)
    if objective == "none":
        raise ValueError("the scenario asks for no optimisation")
    complete = judge.stepped if real_equations(setup).stance == "stepped" else None
    return Criterion(objective, judge.duration, judge.end, complete)


def _inequalities(setup: Setup, within: float) -> Iterator[Inequality]:
    """Margin and clearance, as far as the scenario asks for them."""
    judge, clearance = Judge(setup), least_clearance(setup)
    if (margin := setup.scenario.min_margin) is not None:
        kept = margins(setup, margin + INNER_ROOM)
        yield Inequality("stability margin", kept, judge.margin_lack)
    if clearance is not None:
        from sim.optimisation.clearances import clearances  # casadi need not be there

        kept = clearances(setup, clearance + INNER_ROOM, within)
        yield Inequality("clearance", kept, judge.clearance_lack, relaxed=True)


def margins(
    setup: Setup, least: float
) -> Callable[[Stage, Sequence[Expression]], list[Expression]]:
    """Distance of the weight from each side of its support, less the least margin [m].

    The expressions, of a stage and a state's entries, must not be negative.
    """
    from sim.optimisation.clearances import FIRST_ANGLE, hull_of, outward, place_of

    robot, kinematics = setup.robot, setup.kinematics
    foot, _, _, weight = kinematics.terms

    def of(stage: Stage, state: Sequence[Expression]) -> list[Expression]:
        planted = robot.planted(stage.stratum)
        raised = np.where(planted, 0.0, setup.limits.lift_angle) * robot.raise_sign
        feet, (x, y) = [], map(float, kinematics.center_of_mass[:2])
        for leg, group in enumerate(robot.group_of_leg):
            swing = state[FIRST_ANGLE + group] * float(robot.swing_gain[leg])
            feet.append(place_of(foot[leg], swing, float(raised[leg])))
            moved = place_of(weight[leg], swing, float(raised[leg]))
            x, y = x + moved[0], y + moved[1]
        standing = np.flatnonzero(planted)
        ring = standing[hull_of(kinematics.standing.feet[standing])].tolist()
        sides = sorted(zip(ring, ring[1:] + ring[:1], strict=True))
        return [-outward(feet[i], feet[j], (x, y)) - least for i, j in sides]

    return of
