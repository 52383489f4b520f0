"""The robot card: which parts of an MJCF file are legs, joints, feet and groups.

The classes refuse contradictory values; `checks` checks that the parts exist.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import chain
from math import inf
from typing import Any

from models.description.servos import (
    BOARD_CLOCK,
    DIVIDERS,
    JointServo,
    ServoKind,
    servo_of,
)
from models.errors import message
from planner.support import require_known

# [s]; with slower lifts the slip at lift-off and touchdown no longer decreases
LIFT_TIME = 0.3
QUICKEST_LIFT = 0.001  # [s]
MOST_LEGS, MOST_SOLES, MOST_OTHERS = 40, 400, 1000  # others: patterns, strata of gaits
MOST_GROUPS, MOST_ROWING, MOST_STRATA = 10, 8, 32  # all combinations are looked at
OF_LOGS = ("measured.", "body.", "contact.")  # begin columns of logs
CLOCKS = (20e6, 30e6)  # [Hz]; its data sheet's by a fifth more or less

Twist = tuple[float, float, float]  # forward, left [m/rad], yaw [rad/rad]


@dataclass(frozen=True, slots=True)
class LegCard:
    """The joints and ground-touching geoms of one leg."""

    swing: str  # joint
    lift: str  # joint
    foot: tuple[str, ...]  # geoms
    raise_sign: float = 1  # sign of the lift joint that raises the foot
    hold: Mapping[str, float] = field(default_factory=dict)  # joint -> angle [rad]

    def __post_init__(self) -> None:
        if self.raise_sign not in (-1, 1):
            raise ValueError(f"raise must be 1 or -1, got {self.raise_sign:g}")
        if not self.foot:
            raise ValueError("foot names no geom")
        if self.swing == self.lift:
            raise ValueError(f"swing and lift are the same joint, {self.swing}")

    @property
    def joints(self) -> tuple[str, ...]:
        """All joints of the leg: swing, lift, and those that are held."""
        return (self.swing, self.lift, *self.hold)


@dataclass(frozen=True, slots=True)
class GroupCard:
    """Legs that swing by one angle and lift together."""

    legs: Mapping[int, float]  # leg -> swing of its joint per angle: a sign, or a gain
    twist: Twist | None = None  # claimed, per radian of swing
    # lowest and highest angle, where legs would touch beyond [rad]
    swing: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        _check_gains("a group", "leg", self.legs)
        if self.swing is not None and not self.swing[0] < 0 < self.swing[1]:
            raise ValueError(message("swing_range", given=list(self.swing)))


@dataclass(frozen=True, slots=True)
class PatternCard:
    """Groups that swing together while they stand, such as all legs of a crawl."""

    strata: tuple[str, ...]  # where it is used
    groups: Mapping[str, float]  # group -> its angle per unit of the pattern
    twist: Twist | None = None  # claimed, per unit of the pattern

    def __post_init__(self) -> None:
        if not self.strata:
            raise ValueError("a pattern needs at least one stratum")
        _check_gains("a pattern", "group", self.groups)
        for stratum in self.strata:
            if lifted := [group for group in self.groups if group not in stratum]:
                raise ValueError(f"groups {lifted} are in the air on S{stratum}")


def _check_gains(whole: str, part: str, gains: Mapping[Any, float]) -> None:
    if not gains:
        raise ValueError(f"{whole} needs at least one {part}")
    if bad := {n: gain for n, gain in gains.items() if not 1e-6 <= abs(gain) <= 1e6}:
        raise ValueError(message("gains", part=part, given=bad))


def made_of(kind: str, data: Mapping[str, float]) -> ServoKind:
    """The servo that a robot is built with; a ValueError names the key `kind`."""
    try:
        return servo_of(kind, data)
    except ValueError as error:
        raise ValueError(f"kind {kind!r}: {error}") from error


@dataclass(frozen=True, slots=True)
class Servo:
    """Position servo for joints that have none of their own."""

    stiffness: float  # [N m/rad]
    damping: float  # [N m s/rad]
    made: str = ""  # make of the servos that the robot is built with
    armature: float = 0.0  # inertia of its rotor behind the gears [kg m^2]
    # numbers of its data sheet that are not the make's, by name
    data: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 0 < self.stiffness < inf:
            raise ValueError(f"stiffness must be positive, got {self.stiffness}")
        for name in ("damping", "armature"):
            if not 0 <= (value := getattr(self, name)) < inf:
                raise ValueError(f"{name} must not be negative, got {value}")
        if self.data and not self.made:
            raise ValueError(f"{', '.join(self.data)} need a kind of servo; give kind")
        if self.made:
            made_of(self.made, self.data)

    def __str__(self) -> str:
        rotor = f" and rotors of {self.armature:.3g} kg m^2" if self.armature else ""
        return f"{self.stiffness:.4g} N m/rad, {self.damping:.4g} N m s/rad{rotor}"

    @property
    def settings(self) -> dict[str, float]:
        """What the card says of it, by key."""
        rotor = {"armature": self.armature} if self.armature else {}
        return {"stiffness": self.stiffness, "damping": self.damping, **rotor}


@dataclass(frozen=True, slots=True)
class Card:
    """Everything about a robot that its MJCF file does not say.

    Example:
        >>> from models import load
        >>> card = load("hexapod").card
        >>> card.gait, card.bottom
        (('12', '1', '12', '2', '12'), '12')
    """

    lift_angle: float  # [rad], clears the ground
    legs: Mapping[int, LegCard]
    groups: Mapping[str, GroupCard]
    gait: tuple[str, ...]  # strata, each the names of the groups in contact
    patterns: Mapping[str, PatternCard] = field(default_factory=dict)
    least_load: float = 0.0  # share of the weight on each foot while others step
    lift_time: float = LIFT_TIME  # [s], from the ground to `lift_angle`
    servo: Servo | None = None
    joint_servos: Mapping[str, JointServo] = field(default_factory=dict)
    board_clock: float = BOARD_CLOCK  # of the board that gives pulses [Hz]
    board_divider: int = 0  # of it, for which counts of servos are; 0: the make's
    start: Mapping[str, float] = field(default_factory=dict)  # joint -> angle [rad]
    learnt: tuple[float, ...] = ()  # by a walk with feedback, of what segments miss
    # settings of scenarios that logs of the robot told, and what was said of them
    fitted: Mapping[str, object] = field(default_factory=dict)
    description: str = ""

    def __post_init__(self) -> None:
        for name in ("lift_angle", "lift_time"):
            if not 0 < (value := getattr(self, name)) < inf:
                raise ValueError(f"{name} must be positive, got {value}")
        if self.lift_time < QUICKEST_LIFT:
            raise ValueError(f"lift_time must be {QUICKEST_LIFT} s or more")
        low, high = CLOCKS
        if not low <= self.board_clock <= high:
            facts = {"low": low, "high": high, "given": self.board_clock}
            raise ValueError(message("clock", **facts))
        if self.board_divider not in (0, *range(DIVIDERS[0], DIVIDERS[1] + 1)):
            raise ValueError(message("divider", given=self.board_divider))
        if not self.description.isprintable():
            raise ValueError("description must be one line of printable text")
        if odd := [j for j in self.joints if j == "time" or j.startswith(OF_LOGS)]:
            raise ValueError(f"joint {odd[0]!r} is called as a column of logs is")
        self._check_groups()
        self._check_gait()
        self._check_patterns()
        for joint in self.joint_servos:
            require_known(f"servo.{joint}: this joint", joint, self.joints)
        if not 0 <= (least := self.least_load) < 1 / 3:
            raise ValueError(message("least_load", given=least))

    @property
    def make(self) -> str:
        """Make of its servos; `ideal` where none is named."""
        return (self.servo and self.servo.made) or "ideal"

    @property
    def mounted(self) -> dict[str, JointServo]:
        """Servos of which it is known where they are plugged in, by joint."""
        servos = self.joint_servos.items()
        return {joint: servo for joint, servo in servos if servo.channel is not None}

    def _check_groups(self) -> None:
        for what, some, most in (
            ("strata", self.gait, MOST_OTHERS),
            ("legs", self.legs, MOST_LEGS),
            ("soles", [g for leg in self.legs.values() for g in leg.foot], MOST_SOLES),
            ("groups", self.groups, MOST_ROWING if self.patterns else MOST_GROUPS),
            ("patterns", self.patterns, MOST_OTHERS),
        ):
            if len(some) > most:
                raise ValueError(f"{len(some)} {what}; {most} are the most")
        if odd := [n for n in self.groups if len(n) != 1 or not n.isalnum()]:
            raise ValueError(f"names of groups are a letter or digit each, got {odd}")
        grouped = chain.from_iterable(group.legs for group in self.groups.values())
        for leg in sorted({*self.legs, *grouped}):
            of = [name for name, group in self.groups.items() if leg in group.legs]
            if leg not in self.legs:
                raise ValueError(f"group.{of[0]}: there is no leg {leg}")
            if len(of) != 1:
                groups = " and ".join(of) or "no group"
                raise ValueError(message("one_group", leg=leg, groups=groups))

    def _check_gait(self) -> None:
        if len(self.gait) < 2 or self.gait[0] != self.gait[-1]:
            raise ValueError(message("open_gait", gait=list(self.gait)))
        for stratum in self.gait:
            what = f"gait: stratum {stratum!r}"
            if unknown := sorted(set(stratum) - set(self.groups)):
                facts = {"unknown": unknown[0], "known": ", ".join(self.groups)}
                raise ValueError(message("no_group", what=what, **facts))
            if stratum != (ordered := "".join(g for g in self.groups if g in stratum)):
                raise ValueError(message("order", what=what, ordered=ordered))
            if not stratum:
                raise ValueError("gait: a stratum is empty, with no foot on the ground")
        if (count := len({*self.gait})) > MOST_STRATA:
            raise ValueError(f"{count} different strata; {MOST_STRATA} are the most")

    def _check_patterns(self) -> None:
        for name, pattern in self.patterns.items():
            if not name.isidentifier():
                raise ValueError(f"pattern {name!r}: its name must be one word")
            if unknown := sorted(set(pattern.groups) - set(self.groups)):
                raise ValueError(f"pattern {name}: there is no group {unknown}")
            if unknown := sorted(set(pattern.strata) - set(self.gait)):
                raise ValueError(f"pattern {name}: the gait has no strata {unknown}")
        if (count := sum(len(p.strata) for p in self.patterns.values())) > MOST_LEGS:
            raise ValueError(f"patterns swing on {count} strata; {MOST_LEGS} at most")

    @property
    def joints(self) -> tuple[str, ...]:
        """Joints of all legs, legs in ascending order: swing, lift, those held."""
        return tuple(joint for n in sorted(self.legs) for joint in self.legs[n].joints)

    @property
    def feet(self) -> tuple[str, ...]:
        """Geoms of all feet, legs in ascending order."""
        return tuple(geom for n in sorted(self.legs) for geom in self.legs[n].foot)

    @property
    def group_of_leg(self) -> dict[int, int]:
        """Index of the group of each leg, legs in ascending order."""
        groups = enumerate(self.groups.values())
        return dict(sorted((leg, i) for i, group in groups for leg in group.legs))

    @property
    def bottom(self) -> str:
        """The stratum with every group in contact."""
        return "".join(self.groups)

    @property
    def strata(self) -> tuple[str, ...]:
        """The gait's strata, bottom first, each once."""
        return tuple(dict.fromkeys((self.bottom, *self.gait)))
