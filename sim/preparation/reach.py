"""What a robot cannot walk: directions out of reach, impossible gaits; and remedies."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from models import Equations, Kinematics, Mobility, Robot, mobility_of
from models.adoption import propose
from planner import Gait, Path, PlannerError, StratumError
from planner.extension import AFFORDABLE
from planner.support import limited
from sim.errors import SimulationError, UsageError, message
from sim.motion.poses import relative
from sim.scenarios.scenario import Scenario


def immobile(robot: Robot, found: Mobility) -> Iterator[str]:
    """Why a robot cannot go everywhere, and what would change that, in sentences."""
    if found.lacking:
        yield f"it cannot {' or '.join(found.lacking)}: {found.reason}"
        yield f"what would help: {_remedy(robot)}"


@contextmanager
def explained(robot: Robot, described: Equations) -> Iterator[None]:
    """Explain that a direction is out of reach, where that is why there is no plan."""
    try:
        yield
    except PlannerError as error:
        with limited(30.0):  # [s]; the time for planning may be over
            found = mobility_of(robot, described)
            if not found.lacking:
                raise
            raise _no_plan(robot, found) from error


def require_reach(robot: Robot, described: Equations, path: Path) -> None:
    """Refuse a path that would take thousands of strokes, before it is planned."""
    found = mobility_of(robot, described)
    if not found.lacking:
        return
    poses = np.atleast_2d(path.at(np.linspace(0.0, 1.0, 201)))[:, :3]
    along = np.abs(relative(poses[:-1], poses[1:])).sum(axis=0)  # seen from the body
    ways = dict(zip(("x", "y", "theta"), along, strict=True))
    costs = [(ways[c.direction], c.strokes) for c in found.costs]
    if any(way * strokes > AFFORDABLE for way, strokes in costs if way):
        raise _no_plan(robot, found)


def _no_plan(robot: Robot, found: Mobility) -> SimulationError:
    what = f"no plan, since it cannot {' or '.join(found.lacking)}"
    return SimulationError(what, str(robot), f"{found.reason}; {_remedy(robot)}")


def _remedy(robot: Robot) -> str:
    """What would let a robot go everywhere, tried beforehand."""
    if not (proposal := propose(robot)):
        return message("no_posture")
    return f"{proposal}; `stratawalk adopt` does so for a copy without a card"


def require_gait(scenario: Scenario, robot: Robot, described: Equations) -> None:
    """Refuse a gait that is none of the robot's, or that something else decides."""
    if scenario.gait is None:
        return
    own = " ".join(robot.card.gait)
    written = f"gait = {list(scenario.gait)}"
    try:
        walk = Gait(described.system, scenario.gait)
    except StratumError as error:
        raise UsageError.at(written, error, f"write one such as {own}") from error
    missing = [s for s in described.system.strata if s not in walk.strata]
    if missing:
        what = f"{robot.name} cannot walk without S{missing[0]}"
        raise UsageError(what, written, f"visit it, as in {own}")
    if walk.strata[0] != robot.card.bottom:
        what = f"the gait starts on S{walk.strata[0]}, and walks start on all feet"
        raise UsageError(what, written, f"begin with S{robot.card.bottom}")
    if described.stance == "stepped":
        raise UsageError.of("own_order", written, name=robot.name)
    if scenario.optimise != "none":
        raise UsageError.of("order_twice", written, optimise=scenario.optimise)


def lift_angle(kinematics: Kinematics, height: float | None) -> float:
    """Angle that raises every foot by a height [m]; the card's own if none is given."""
    if height is None:
        return kinematics.robot.card.lift_angle
    if height > kinematics.highest:
        heights = {"height": height, "highest": kinematics.highest}
        raise UsageError.of("too_high", kinematics.robot, **heights)
    return kinematics.lift_to(height)
