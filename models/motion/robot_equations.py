"""A robot's equations of motion, eqs. (16)-(19), and where its swings can take it.

Twists of swings are claims of the card or follow from contact kinematics. Field `gS_i`
swings group i on stratum S, and `gS_NAME` a pattern of groups that the card names. Two
swings move the body, each about its pivot or straight ahead, and their bracket moves it
across, unless the pivots coincide or neither swing turns the body.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import Literal, get_args

import numpy as np

from models.contact.dissipation import least_dissipation_twist
from models.contact.kinematics import Kinematics
from models.contact.loads import StaticStability, static_loads
from models.description.card import Twist
from models.description.robot import Robot
from models.errors import ModelError, message
from models.motion.equations_of_motion import POSE, Direction, Swing, walking_system
from planner import Execution, Path, PlannerError, StratifiedSystem
from planner.execution import StabilityTest, StanceRule
from planner.extension import AFFORDABLE, DirectionCost, stroke_costs
from planner.systems import ShapeLimits

Fields = Literal["paper", "lifted"]


@dataclass(frozen=True, slots=True)
class Equations:
    """A robot as a stratified system, with the elements to steer it by.

    Example:
        >>> from models import equations, load
        >>> hexapod = equations(load("hexapod"))
        >>> hexapod.twists["g1_1"]  # forward, left [m/rad], yaw [rad/rad]
        (0.0378, 0.0, 0.56)
    """

    system: StratifiedSystem
    elements: tuple[str, ...]
    twists: Mapping[str, Twist]  # field -> body twist per unit; zero in the air
    swings: Mapping[str, Direction]  # field -> what it does to the groups' angles
    stance: StanceRule  # how its strokes are centred
    static_stability: StabilityTest | None  # None where the robot always stands
    limits: ShapeLimits  # joint range of every group's angle [rad]

    @property
    def execution(self) -> Execution:
        """Strokes centred within the joint range; stepped where groups row together."""
        return Execution(
            stance=self.stance,
            limits=self.limits,
            static_stability=self.static_stability,
        )

    def configurations(self, path: Path) -> Path:
        """A path of poses as configurations: legs at angle 0, feet on the ground."""
        if np.size(path(0.0)) == self.system.dimension:
            return path
        rest = self.system.dimension - len(POSE)
        return Path(lambda s: np.pad(path.at(s), ((0, 0), (0, rest))), path.corners)

    @property
    def strokes(self) -> dict[str, float]:
        """How far each field swings from one end of the joint range to the other."""
        widths = np.ptp(list(self.limits.values()), axis=1)
        return {
            name: float(min(w / abs(r) for w, r in zip(widths, way, strict=True) if r))
            for name, way in self.swings.items()
        }

    def stride(self, field: str) -> float:
        """Way of the body's centre per unit of a field [m]."""
        return hypot(*self.twists[field][:2])


def equations(robot: Robot, fields: Fields = "lifted") -> Equations:
    """The stratified system of a robot with constant twists.

    Args:
        robot: Robot to describe.
        fields: For two groups that alternate: `paper` steers with loaded groups
            swinging on the bottom stratum, `lifted` never lets a loaded group swing
            against another one. Others have one choice.

    Raises:
        ModelError: If groups do not stand where they swing, or cannot be steered.
        ValueError: If there are no such fields.

    Example:
        >>> from models import equations, load
        >>> equations(load("hexapod"), "paper").elements
        ('g12_1', 'g12_2', 'g1_2', 'g2_1', '[g12_1,g12_2]')
    """
    if fields not in (known := get_args(Fields)):
        raise ValueError(f"fields is {fields!r}; choose {' or '.join(known)}")
    card, kinematics = robot.card, Kinematics(robot)
    swings = tuple(s for name in card.strata for s in _swings(kinematics, name))
    contacts = tuple((name, name) for name in card.strata)
    # a robot that rows in patterns on all feet is centred by stepping in between
    centred: StanceRule = "stepped" if card.patterns else "centred"
    elements = _elements(robot, swings, fields)  # before all fields are made
    return Equations(
        system=walking_system(robot.groups, contacts, swings, radius=kinematics.reach),
        elements=elements,
        twists={swing.name: swing.twist or (0.0, 0.0, 0.0) for swing in swings},
        swings={swing.name: swing.direction for swing in swings},
        stance="paper" if fields == "paper" else centred,
        static_stability=StaticStability(robot).stands if card.least_load else None,
        limits={f"phi_{name}": span for name, span in robot.swing_range.items()},
    )


def _swings(kinematics: Kinematics, stratum: str) -> Iterator[Swing]:
    """Swings on a stratum: single groups, or patterns in place of those that stand."""
    robot = kinematics.robot
    patterns = robot.card.patterns
    for i, group in enumerate(robot.groups):
        stands = group in stratum
        if not (stands and patterns):
            twist = group_twist(kinematics, group) if stands else None
            yield Swing(stratum, str(i + 1), _unit(robot, i), twist)
    for name, pattern in patterns.items():
        if stratum in pattern.strata:
            direction = tuple(pattern.groups.get(g, 0.0) for g in robot.groups)
            twist = pattern.twist or twist_at_rest(kinematics, stratum, direction)
            yield Swing(stratum, name, direction, twist)


def _unit(robot: Robot, index: int) -> Direction:
    return tuple(float(i == index) for i in range(len(robot.groups)))


def group_twist(kinematics: Kinematics, group: str) -> Twist:
    """Body twist per radian of a group that stands alone: claimed, or by contact."""
    robot = kinematics.robot
    if claimed := robot.card.groups[group].twist:
        return claimed
    return twist_at_rest(kinematics, group, _unit(robot, robot.groups.index(group)))


def twist_at_rest(kinematics: Kinematics, stratum: str, direction: Direction) -> Twist:
    """Body twist by contact kinematics, all legs at angle 0 and equally soft."""
    robot, stance = kinematics.robot, kinematics.standing
    on = robot.planted(stratum)
    feet, moved = stance.feet[on][None], np.array(direction)[robot.group_of_leg, None]
    rates = (stance.rates * moved)[on][None]
    loads = static_loads(feet, stance.center_of_mass[None])
    if (loads > 1e-9).sum() < 3:
        raise ModelError(message("no_stand", groups=stratum, source=robot.path))
    twist = least_dissipation_twist(feet, rates, loads)[0]
    # the last digits are the solver's and not the robot's
    forward, left, yaw = (round(float(value), 9) + 0.0 for value in twist)
    return forward, left, yaw


def _elements(robot: Robot, swings: Sequence[Swing], fields: Fields) -> tuple[str, ...]:
    """Loaded swings to steer with, those in the air on first strata, and a bracket."""
    if robot.card.patterns:
        names = [swing.name for swing in swings if swing.twist is not None]
    else:
        units = {_unit(robot, i): group for i, group in enumerate(robot.groups)}
        names = [
            swing.name
            for swing in swings
            if (group := units.get(swing.direction))
            and swing.stratum == (robot.card.bottom if fields == "paper" else group)
        ]
    if len(names) != 2:
        facts = {"gait": " ".join(robot.card.gait), "count": len(names)}
        raise ModelError(message("two_swings", source=robot.path, **facts))
    lifted: dict[Direction, str] = {}
    for swing in swings:
        if swing.twist is None:
            lifted.setdefault(swing.direction, swing.name)
    for i, group in enumerate(robot.groups):
        if _unit(robot, i) not in lifted:
            raise ModelError(f"the gait never lifts group {group}: {robot.path}")
    return (*names, *lifted.values(), f"[{names[0]},{names[1]}]")


WAYS = dict(zip(map(str, POSE), ("go forward", "go sideways", "turn"), strict=True))
STRAIGHT = 1e-3  # rad of yaw while the body moves by the size of its stance


@dataclass(frozen=True)
class Mobility:
    """What the swings of a robot can do.

    Attributes:
        costs: Strokes for a metre of x and y, and for a radian of yaw.
        lacking: What the robot cannot do, such as `go sideways`; empty if nothing.
        reason: Why it cannot, in words; empty if nothing is lacking.

    Example:
        >>> from models import equations, load, mobility_of
        >>> parallel = load("hexapod-parallel")
        >>> [c.direction for c in mobility_of(parallel, equations(parallel)).costs]
        ['x', 'y', 'theta']
    """

    costs: tuple[DirectionCost, ...]
    lacking: tuple[str, ...]
    reason: str


def mobility_of(robot: Robot, described: Equations) -> Mobility:
    """What the swings of a robot, by its equations, can do from where it stands.

    Example:
        >>> from models import equations, load, mobility_of
        >>> robot = load("hexapod")
        >>> mobility_of(robot, equations(robot)).lacking
        ()
    """
    system, elements = described.system, described.elements
    at = np.zeros(system.dimension)
    try:
        found = stroke_costs(system, elements, at, described.strokes)
    except PlannerError:  # the bracket vanishes
        found = stroke_costs(system, elements[:-1], at, described.strokes)
    costs = tuple(cost for cost in found if cost.direction in WAYS)
    reached = {cost.direction for cost in costs if not cost.in_theory_only}
    lacking = tuple(words for name, words in WAYS.items() if name not in reached)
    return Mobility(costs, lacking, _reason(robot, described) if lacking else "")


def _reason(robot: Robot, described: Equations) -> str:
    size = Kinematics(robot).reach
    twists = [described.twists[name] for name in described.elements[:2]]
    turning = [abs(yaw) * size > STRAIGHT * hypot(*way) for *way, yaw in twists]
    if not any(turning):
        return message("straight")
    if all(turning):
        # points of the body that strokes leave in place [m]
        (x, y), (u, v) = [(-left / yaw, ahead / yaw) for ahead, left, yaw in twists]
        if (apart := hypot(x - u, y - v)) < 0.25 * size:  # nearly one
            return message("one_pivot", x=x, y=y, apart=1e3 * apart)
    return message("short", most=AFFORDABLE)
