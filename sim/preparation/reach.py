"""Directions that a robot's swings do not reach: why not, and what would help."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from models import Equations, Mobility, Robot, mobility_of, propose
from planner import PlannerError, limited
from sim.errors import SimulationError

LOOKING = 30.0  # [s] for the reason and the remedy


def immobile(robot: Robot, found: Mobility) -> Iterator[str]:
    """Why a robot cannot go everywhere, and what would change that, in sentences.

    Args:
        robot: Robot in question.
        found: What its swings can do.
    """
    if found.lacking:
        yield f"it cannot {' or '.join(found.lacking)}: {found.reason}"
        yield f"what would help: {_remedy(robot)}"


@contextmanager
def explained(robot: Robot, described: Equations) -> Iterator[None]:
    """Explain why there is no plan, where the robot cannot go everywhere.

    Args:
        robot: Robot that is to follow a plan.
        described: Its equations.

    Raises:
        SimulationError: There is no plan, because a direction is out of reach.
    """
    try:
        yield
    except PlannerError as error:
        with limited(LOOKING):  # the time for planning may be over
            found = mobility_of(robot, described)
            if not found.lacking:
                raise
            raise SimulationError(
                f"no plan, since it cannot {' or '.join(found.lacking)}",
                str(robot),
                f"{found.reason}; {_remedy(robot)}",
            ) from error


def _remedy(robot: Robot) -> str:
    """What would let a robot go everywhere, tried beforehand."""
    if (proposal := propose(robot)) is None:
        return (
            "legs that are mounted elsewhere or have more room to swing; no groups and "
            "posture of these legs were found in which it goes everywhere"
        )
    return f"{proposal}; `stratawalk adopt` gives that to a copy without a card"
