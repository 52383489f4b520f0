"""What `plan` says about accuracy: how fast plans converge, and what is faster."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from planner import ExtendedSystem, Path
    from planner.execution import Coordinates


def convergence(
    extended: ExtendedSystem, path: Path, coordinates: Coordinates
) -> dict[str, Any]:
    """The order to expect, None where plans are exact, and of what is faster.

    Args:
        extended: System to steer.
        path: Configurations to follow.
        coordinates: Words of the plan.
    """
    from planner import convergence_order
    from planner.planning import faster

    expected = convergence_order(extended, path, coordinates)
    offers = faster(extended, path, coordinates)
    return {
        "degree": expected.degree,
        "bracket_degree": expected.bracket_degree,
        "order": _finite(expected.order),
        "faster": {what: _finite(offer.order) for what, offer in offers.items()},
    }


def step_lengths(
    extended: ExtendedSystem, path: Path, segments: int
) -> dict[str, float | None] | None:
    """The first step of a path and the critical one; None if twice the first serves.

    Args:
        extended: System to steer.
        path: Configurations to follow.
        segments: Number of pieces that the path is cut into.
    """
    import numpy as np

    from planner import critical_step
    from planner.planning import grid

    start, end = path.at(grid(path, segments)[:2])
    if not (length := float(np.linalg.norm(end - start))):
        return None
    critical = critical_step(extended, start, end - start, within=2 * length)
    return {"first": length, "critical": _finite(critical)}


def _finite(value: float) -> float | None:
    return None if math.isinf(value) else value


def describe(facts: Mapping[str, Any]) -> list[str]:
    """Accuracy and steps in lines for a terminal, of facts that have them."""
    lines = describe_order(facts["accuracy"]) if "accuracy" in facts else []
    if steps := facts.get("steps"):
        exact = facts["accuracy"]["order"] is None
        lines.append(describe_steps(steps, facts["segments"], exact))
    return lines


def describe_steps(
    steps: Mapping[str, float | None], segments: int, exact: bool
) -> str:
    """The number of segments beside the one that the critical step would ask for."""
    first, critical = steps["first"], steps["critical"]
    if first is None or (exact and critical is None):
        return f"{'steps':10}of any length are halved at least by one plan"
    if critical == 0:
        return f"{'steps':10}of no length converge in this direction"
    length = "beyond twice that" if critical is None else f"{critical:.3g}"
    of = f"of {first:.3g}, the critical step is {length}"
    if critical is None or first <= critical:
        return f"{'steps':10}{of}: short enough to converge when repeated"
    needed = math.ceil(segments * first / critical)
    return f"{'steps':10}{of}: too long to converge when repeated, {needed} would do"


def describe_order(facts: Mapping[str, Any]) -> list[str]:
    """The order to expect and what raises it."""
    degree = f"degree {facts['degree']}"
    if facts["order"] is None:
        return [f"{'accuracy':10}exact at {degree}: no brackets are left out"]
    lines = [
        f"{'accuracy':10}n segments miss by n^-{facts['order']:.3g} ({degree}, "
        f"brackets of degree {facts['bracket_degree']})"
    ]
    if facts["faster"]:
        offers = (f"{what} {_power(order)}" for what, order in facts["faster"].items())
        lines.append(f"{'faster':10}{', '.join(offers)}; redundant elements miss less")
    return lines


def _power(order: float | None) -> str:
    return "is exact" if order is None else f"n^-{order:.3g}"
