"""What `plan` says about accuracy: how fast plans converge, and what is faster."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from planner import Coordinates, ExtendedSystem, Path


def convergence(
    extended: ExtendedSystem, path: Path, coordinates: Coordinates
) -> dict[str, Any]:
    """The order to expect, None where plans are exact, and of what is faster.

    Args:
        extended: System to steer.
        path: Configurations to follow.
        coordinates: Words of the plan.
    """
    from planner import convergence_order, faster

    expected = convergence_order(extended, path, coordinates)
    offers = faster(extended, path, coordinates)
    return {
        "degree": expected.degree,
        "bracket_degree": expected.bracket_degree,
        "order": _finite(expected.order),
        "faster": {what: _finite(offer.order) for what, offer in offers.items()},
    }


def _finite(order: float) -> float | None:
    return None if math.isinf(order) else order


def describe(facts: dict[str, Any]) -> list[str]:
    """The facts in lines for a terminal."""
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
