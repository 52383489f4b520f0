"""The task that a scenario gives to the optimiser, in the planner's terms.

The strokes move the body as the real contacts do, and time is that of the schedule. The
path is followed as closely as the scenario demands, or as closely as its stratified
plan follows it.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from math import inf, pi

from models import Equations
from models.motion import contact_equations, contact_fields
from planner.optimisation import CHEAP, Criterion, Inequality, Task, Tolerance, cycle
from sim.experiments.predictions import twist_model
from sim.optimisation.clearances import clearances, margins
from sim.optimisation.judging import Judge, least_clearance, real_prediction
from sim.preparation.setup import Setup

RANGE_ROOM = 1e-4  # [rad] kept from the ends of the joint range, for servos
ROUGH = 1e-6  # [m/rad], [rad/rad] of fields; the aim makes up for what they leave out
INNER_ROOM = 1e-4  # [m] of margin and clearance, kept between the ends of strokes


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
        centred=described.stance == "stepped",
        inequalities=tuple(_inequalities(setup, within[0])),
    )


def criterion_of(setup: Setup) -> Criterion:
    """What is to be least, and how flows are measured."""
    objective, judge = setup.scenario.optimise, Judge(setup)
    if objective == "none":
        raise ValueError("the scenario asks for no optimisation")
    return Criterion(
        objective=objective,
        duration=judge.duration,
        predict=judge.end,
        complete=judge.stepped if real_equations(setup).stance == "stepped" else None,
    )


def _inequalities(setup: Setup, within: float) -> Iterator[Inequality]:
    """Margin and clearance, as far as the scenario asks for them."""
    judge, clearance = Judge(setup), least_clearance(setup)
    if (margin := setup.scenario.min_margin) is not None:
        kept = margins(setup, margin + INNER_ROOM)
        yield Inequality("stability margin", kept, judge.margin_lack)
    if clearance is not None:
        kept = clearances(setup, clearance + INNER_ROOM, within)
        yield Inequality("clearance", kept, judge.clearance_lack, relaxed=True)
