"""Whether a robot can walk in the order of the gait that a scenario gives, eq. (11)."""

from __future__ import annotations

from models import Equations, Robot
from planner import Gait, StratumError
from sim.errors import UsageError
from sim.scenarios.scenario import Scenario


def require_gait(scenario: Scenario, robot: Robot, described: Equations) -> None:
    """Check that plans can follow the scenario's gait, if it gives one.

    Args:
        scenario: The scenario.
        robot: Robot that it walks.
        described: The robot's equations.

    Raises:
        UsageError: If the gait is none of the robot, or something else decides the
            order of strata.
    """
    if scenario.gait is None:
        return
    own = " ".join(robot.card.gait)
    written = f"gait = {list(scenario.gait)}"
    try:
        walk = Gait(described.system, scenario.gait)
    except StratumError as error:
        remedy = f"give an order of this robot's strata, such as {own}"
        raise UsageError(str(error), written, remedy) from error
    missing = [s for s in described.system.strata if s not in walk.strata]
    if missing:
        what = f"{robot.name} cannot walk without S{missing[0]}"
        raise UsageError(what, written, f"visit it, as in {own}")
    if walk.strata[0] != robot.card.bottom:
        what = f"the gait starts on S{walk.strata[0]}, and walks start on all feet"
        raise UsageError(what, written, f"begin with S{robot.card.bottom}")
    if described.stance == "stepped":
        what = f"{robot.name} lifts its legs in the order in which it stands safely"
        raise UsageError(what, written, "leave gait out for this robot")
    if scenario.optimise != "none":
        what = f"optimise = {scenario.optimise} chooses the order of strata itself"
        raise UsageError(what, written, "leave out one of the two")
