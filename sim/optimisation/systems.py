"""The shortest plans of systems that are not robots.

The duration of a plan is the time that its flows take at unit speed. Coordinates that
every field moves at a constant rate, such as the angles of legs, are not bound to the
path on the way.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from models import Problem
from planner import (
    BoundError,
    Execution,
    ExtendedSystem,
    Flow,
    Path,
    Plan,
    contact_switches,
    plan,
    rollout,
)
from planner.optimisation import (
    Criterion,
    Objective,
    Optimiser,
    Task,
    Tolerance,
    cycle,
    deviation,
)

LEAST = 0.01  # tolerance, in sizes of the path, where the stratified plan strays less
CHEAP = 0.01  # cost of a recovery in the air where strokes alone are to be short
SAMPLES = 8  # of a flow
POINTS = 1001  # of the path


def shortest(
    problem: Problem, compiled: ExtendedSystem, stratified: Plan, objective: Objective
) -> Plan:
    """The shortest plan found that strays no farther than the stratified one.

    Args:
        problem: What to reach.
        compiled: Its extended system.
        stratified: The first guess, which stands where nothing shorter is found.
        objective: What is to be least.

    Raises:
        PlannerError: If a field is known as a function only, or CasADi is missing.
    """
    system, names = problem.system, [str(s) for s in problem.system.state]
    stages = cycle(system, problem.elements)
    airs = {
        r.field
        for stage in stages
        for r in stage.recoveries
        if stage.stratum != system.bottom
    }
    cheap = CHEAP if objective == "strokes" else 1.0
    task = Task(
        system=system,
        stages=stages,
        tolerances=_tolerances(problem, compiled, stratified),
        limits={names.index(name): span for name, span in problem.limits.items()},
        price={name: cheap if name in airs else 1.0 for name in system.fields},
    )

    def coarse(begin: float, end: float, segments: int) -> Sequence[Flow]:
        piece = Path(lambda s: problem.path.at(begin + (end - begin) * s))
        return plan(compiled, piece, segments, execution=Execution()).flows

    def worth(found: Plan) -> float:
        if objective == "switches":
            return contact_switches(system, found.flows)
        return sum(task.cost(f.field) * abs(f.duration) for f in found.flows)

    optimiser = Optimiser(
        task,
        Criterion(objective, duration),
        compiled,
        problem.path,
        problem.segments,
        coarse=coarse,
    )
    try:
        return min(optimiser.plan(), stratified, key=worth)
    except BoundError:
        return stratified


def duration(flows: Sequence[Flow]) -> float:
    """Time of flows at unit speed."""
    return sum(abs(flow.duration) for flow in flows)


def _tolerances(
    problem: Problem, compiled: ExtendedSystem, stratified: Plan
) -> tuple[Tolerance, ...]:
    """The stratified plan's own deviations, of x and y together and of the others."""
    names = [str(s) for s in problem.system.state]
    compared = [i for i in range(len(names)) if i not in compiled.shape.coordinates]
    place = [names.index(n) for n in ("x", "y") if n in names]
    groups = [place] if place else []
    groups += [[i] for i in compared if i not in place]
    points = problem.path.at(np.linspace(0.0, 1.0, POINTS))
    found = deviation(rollout(stratified, SAMPLES), points, groups)
    least = LEAST * float(np.abs(points - points[0]).max())
    return tuple(
        Tolerance(tuple(group), max(most, least))
        for group, most in zip(groups, found, strict=True)
    )
