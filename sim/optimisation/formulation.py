"""The task that a scenario gives to the optimiser, in the planner's terms.

The strokes move the body as the real contacts do, and time is that of the schedule. The
path is followed as closely as the scenario demands, or as closely as its stratified
plan follows it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf, pi

from models import Equations
from models.motion import contact_equations, contact_fields
from planner import Execution, ExtendedSystem, Flow, Path, Plan, plan, play
from planner.optimisation import Criterion, Inequality, Task, Tolerance, cycle
from sim.experiments.predictions import twist_model
from sim.motion.path_deviation import PathDeviation, path_deviation
from sim.optimisation.clearances import clearances, margins
from sim.optimisation.judging import Judge, least_clearance, real_prediction
from sim.preparation.setup import Setup

RANGE_ROOM = 1e-4  # [rad] kept from the ends of the joint range, for servos
LEAST_POSITION, LEAST_YAW = 1e-3, 1e-2  # [m], [rad]; of a tolerance that is not given
ROUGH = 1e-6  # [m/rad], [rad/rad] of fields; the aim makes up for what they leave out
CHEAP = 0.01  # cost of a recovery where strokes alone are to be short
FLOW_SAMPLES = 8  # of a flow of the stratified plan
PATH_POINTS = 1001  # that a plan's deviation is measured from
INNER_ROOM = (
    1e-4  # [m] of margin and clearance, for what lies between the ends of strokes
)


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


def tolerances(setup: Setup, stratified: Plan | None) -> tuple[float, float]:
    """Largest deviation of the walk from the path [m], and from its yaw [rad].

    Where none is given, that of the stratified plan stands.
    """
    scenario = setup.scenario
    given = scenario.path_tolerance, scenario.yaw_tolerance
    own = LEAST_POSITION, LEAST_YAW
    if stratified is not None and None in given:
        found = own_deviation(setup, stratified)
        own = max(own[0], found.position), max(own[1], found.yaw)
    position, yaw = given
    return own[0] if position is None else position, own[1] if yaw is None else yaw


def own_deviation(setup: Setup, plan: Plan) -> PathDeviation:
    """Deviation of a plan from the nominal path, by the fields it is of."""
    states = play(plan.system, plan.flows, plan.start, FLOW_SAMPLES)
    return path_deviation(setup.scenario.path.curve, states[:, :3])


def task_of(setup: Setup, within: tuple[float, float]) -> Task:
    """Fields, stages, margin and clearance to keep, within deviations [m] and [rad]."""
    scenario, described = setup.scenario, real_equations(setup)
    system = described.system
    names = [str(symbol) for symbol in system.state]
    pace = {
        name: max(map(abs, direction)) / setup.limits.swing_speed
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
        centred=_centred(setup),
        inequalities=tuple(_inequalities(setup, within[0])),
    )


def criterion_of(setup: Setup) -> Criterion:
    """What is to be least, and how flows are measured.

    Raises:
        ValueError: The scenario asks for no optimisation.
    """
    objective, judge = setup.scenario.optimise, Judge(setup)
    if objective == "none":
        raise ValueError("the scenario asks for no optimisation")
    return Criterion(
        objective=objective,
        duration=judge.duration,
        predict=judge.end,
        complete=judge.stepped if _centred(setup) else None,
    )


def _centred(setup: Setup) -> bool:
    return real_equations(setup).stance == "stepped"


def _inequalities(setup: Setup, within: float) -> Iterator[Inequality]:
    """Margin and clearance, as far as the scenario asks for them."""
    margin, clearance = setup.scenario.min_margin, least_clearance(setup)
    judge = Judge(setup)
    if margin is not None:
        yield Inequality(
            "stability margin",
            margins(setup, margin + INNER_ROOM),
            judge.margin_lack,
        )
    if clearance is not None:
        yield Inequality(
            "clearance",
            clearances(setup, clearance + INNER_ROOM, within),
            judge.clearance_lack,
            relaxed=True,
        )


@dataclass(frozen=True)
class Coarse:
    """Stratified plans of pieces of a path, in few segments."""

    extended: ExtendedSystem
    path: Path
    execution: Execution

    def __call__(self, begin: float, end: float, segments: int) -> Sequence[Flow]:
        """Flows from one place on the path to another."""
        piece = Path(lambda s: self.path.at(begin + (end - begin) * s))
        return plan(self.extended, piece, segments, execution=self.execution).flows
