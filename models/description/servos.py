"""Servos by the numbers of their data sheets, and as they are mounted.

A hobby servo is a proportional controller with a direct-current motor behind a gear
train. Near its target it is a spring: the stall torque divided by the error at which
its controller gives full voltage. Controllers are taken to be critically damped,
whatever inertia they move. Makes stand in `makes.toml`, as data sheets have them. The
servo of one joint takes the count center + sign * counts_per_radian * (angle - offset).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, isfinite, pi, radians
from typing import Any, Literal

from planner.support import did_you_mean, require_known, shipped_tables

# [s]; 52 and 63 ms were measured on an STS3215 and an XL-330 (github.com/Rhoban/bam),
# 14 ms follow from 240 : 1 on a coreless rotor of 4e-9 kg m^2, as of an MG90S
START_UP = 0.03
OF_MOTOR = ("stall_torque", "no_load_speed")
BOARD_CLOCK = 25e6  # [Hz]; of a PCA9685, by its data sheet
DIVIDERS = (4, 256)  # whole numbers, by which it divides its clock
BOARD_COUNTS = 4096  # in a frame
NOT_NEGATIVE = (
    "command_rate", "resolution", "volts", "dead_band", "backlash", "profile_speed",
    "armature",
)  # fmt: skip
OF_SHEETS = 1e-15, 1e6  # least and largest of such numbers, in the units below
NUMBERS = (*OF_MOTOR, "full_error", "center", "reach", *NOT_NEGATIVE)
"""Numbers of a data sheet, by the names that cards and scenarios give them."""


def board_divider(rate: float, clock: float = BOARD_CLOCK) -> int:
    """By what a PCA9685 divides its clock [Hz] for so many frames a second."""
    least, most = DIVIDERS
    return min(max(round(clock / (BOARD_COUNTS * rate)), least), most)


def board_rate(rate: float, clock: float = BOARD_CLOCK) -> float:
    """Frames a second that a PCA9685 gives when it is asked for a rate [1/s]."""
    return clock / (BOARD_COUNTS * board_divider(rate, clock))


@dataclass(frozen=True, slots=True)
class ServoKind:
    """One make of servo, and how it takes commands.

    Attributes:
        stall_torque: Largest torque, at no speed [N m].
        no_load_speed: Largest speed, at no torque [rad/s].
        full_error: Error at which the controller gives all of the torque [rad].
        command_rate: Commands taken in a second; 0 for one a physics step [1/s].
        resolution: Angle of one count of a command; 0 for none [rad].
        center: Count of angle zero.
        reach: Farthest that it turns from its centre [rad].
        signal: `pulse` for those of a PCA9685, `bus` for ticks on a bus.
        volts: Voltage that torque and speed belong to; 0 where it is not known [V].
        dead_band: Whole width of the error in which it gives no torque [rad].
        backlash: That of the gears; 0 where it is not known [rad].
        profile_speed: Largest speed that it is set to go at; 0 for none [rad/s].
        armature: Inertia of the rotor behind the gears; 0 where nobody has measured it
            [kg m^2].
        source: Where the numbers come from.

    Raises:
        ValueError: A number is not finite, or of the wrong sign.

    Example:
        >>> from models import ServoKind
        >>> ServoKind(stall_torque=1.0, no_load_speed=6.0, full_error=0.1).stiffness
        10.0
    """

    stall_torque: float
    no_load_speed: float
    full_error: float
    command_rate: float = 0.0
    resolution: float = 0.0
    center: int = 0
    reach: float = pi
    signal: Literal["pulse", "bus"] = "pulse"
    volts: float = 0.0
    dead_band: float = 0.0
    backlash: float = 0.0
    profile_speed: float = 0.0
    armature: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        for name in ("stall_torque", "no_load_speed", "full_error", "reach"):
            if not 0 < (value := getattr(self, name)) < inf:
                raise ValueError(f"{name} must be positive and finite, got {value}")
        for name in NOT_NEGATIVE:
            if not 0 <= (value := getattr(self, name)) < inf:
                raise ValueError(f"{name} must not be negative: {value}")

    @property
    def stiffness(self) -> float:
        """Torque an error near zero [N m/rad]."""
        return self.stall_torque / self.full_error

    def at_rate(self, rate: float) -> "ServoKind":
        """The servo given so many commands a second; 0 for one a physics step.

        Pulses are counted in parts of a frame, so their counts are as many times finer
        as frames are shorter. On a bus, and at a rate of 0, counts stay.
        """
        if self.signal != "pulse" or not (rate and self.command_rate):
            return replace(self, command_rate=rate)
        finer = rate / self.command_rate
        resolution, center = self.resolution / finer, round(self.center * finer)
        return replace(self, command_rate=rate, resolution=resolution, center=center)

    def with_numbers(self, given: Mapping[str, float]) -> "ServoKind":
        """The servo with other numbers of its data sheet.

        Another voltage alone changes torque and speed in proportion, and another rate
        the counts of pulses. A number that no servo has is a ValueError.
        """
        for name in given.keys() - {*NUMBERS}:
            raise ValueError(f"a servo has no {name!r}; {did_you_mean(name, NUMBERS)}")
        for name, value in given.items():
            if value and not OF_SHEETS[0] <= abs(value) <= OF_SHEETS[1]:
                raise ValueError(f"{name} = {value:g} is of no servo; correct it")
        ratio = given["volts"] / self.volts if "volts" in given and self.volts else 1.0
        scaled = {name: ratio * getattr(self, name) for name in OF_MOTOR}
        values: dict[str, Any] = (scaled if ratio != 1.0 else {}) | dict(given)
        if self.signal == "pulse" and not values.get("command_rate", 1.0):
            raise ValueError("command_rate must be positive for servos on pulses")
        if "center" in values:
            values["center"] = round(values["center"])
        return replace(
            self.at_rate(given.get("command_rate", self.command_rate)), **values
        )

    @property
    def lost_torque(self) -> float:
        """Torque that the motor loses with its speed [N m s/rad]."""
        return self.stall_torque / self.no_load_speed

    @property
    def rotor(self) -> float:
        """Inertia of the rotor behind the gears, measured or likely [kg m^2].

        A motor on its full voltage comes to 63 % of its speed within its inertia over
        the torque that it loses with speed.
        """
        return self.armature or START_UP * self.lost_torque


@dataclass(frozen=True, slots=True, kw_only=True)
class JointServo:
    """The servo of one joint; None leaves a value to the make of the servo.

    Attributes:
        channel: Output of the servo controller, or the servo's number on its bus.
        sign: 1 where counts grow with the joint's angle, otherwise -1.
        center: Count of the servo's centre.
        offset: Angle of the joint at the servo's centre [rad].
        counts_per_radian: Counts that turn the servo by a radian.
        limits: Lowest and highest angle of the joint [rad].

    Raises:
        ValueError: A value is impossible.

    Example:
        >>> from models import JointServo
        >>> JointServo(channel=3, sign=-1).offset
        0.0
    """

    channel: int | None = None
    sign: float = 1
    center: float | None = None
    offset: float = 0.0
    counts_per_radian: float | None = None
    limits: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("channel", "center"):
            value = getattr(self, name)
            if value is not None and not 0 <= value < inf:
                raise ValueError(f"{name} must not be negative, got {value}")
        if self.channel is not None and self.channel % 1:
            raise ValueError(f"channel must be a whole number, got {self.channel}")
        if self.sign not in (-1, 1):
            raise ValueError(f"sign must be 1 or -1, got {self.sign:g}")
        if not isfinite(self.offset):
            raise ValueError(f"offset must be finite, got {self.offset}")
        counts = self.counts_per_radian
        if counts is not None and not 0 < counts < inf:
            raise ValueError(f"counts_per_radian must be positive, got {counts}")
        match self.limits:
            case None:
                return
            case (low, high) if -inf < low < high < inf:
                return
        what = "limits are the lowest and the highest angle"
        raise ValueError(f"{what}, got {list(self.limits)}")


PULSES, BUS = 50.0, 100.0  # commands a second, the latter assumed where none is given
IN_COUNTS = {
    "dead_counts": "dead_band",
    "full_counts": "full_error",
    "profile_counts": "profile_speed",
}


def _kind(sheet: dict[str, Any]) -> ServoKind:
    """A servo from its table."""
    if "kgf_cm" in sheet:
        sheet["stall_torque"] = sheet.pop("kgf_cm") * 0.0980665  # [N m]
        sheet["no_load_speed"] = pi / 3 / sheet.pop("seconds")  # for 60 degrees
    if degrees := sheet.pop("degrees", 0):
        sheet["reach"] = radians(degrees / 2)
    if dead := sheet.pop("dead_pulse", 0):
        a_microsecond, count = radians(degrees / 2000), 1e6 / BOARD_COUNTS / PULSES
        sheet |= {"dead_band": a_microsecond * dead, "command_rate": PULSES}
        sheet |= {"full_error": 3 * a_microsecond * dead, "center": round(1500 / count)}
        sheet["resolution"] = a_microsecond * count
    if number := sheet.pop("counts", 0):
        count = radians(degrees / number)
        ours = {key: sheet.pop(key) * count for key in IN_COUNTS if key in sheet}
        sheet |= {IN_COUNTS[key]: angle for key, angle in ours.items()}
        rate = sheet.get("command_rate", BUS)
        sheet |= {"resolution": count, "center": number // 2, "command_rate": rate}
        sheet["signal"] = "bus"
    return ServoKind(**sheet)


_SHEETS = shipped_tables("models.description", "makes.toml")

ALSO = {n: make for make, sheet in _SHEETS.items() for n in sheet.pop("also", ())}
KNOWN_SERVOS = {name: _kind(sheet) for name, sheet in _SHEETS.items()}
GENERIC = ("pulse", "bus")  # of no make, with torque and speed of a data sheet
SERVO_KINDS = {n: kind for n, kind in KNOWN_SERVOS.items() if n not in GENERIC}
"""Servos by name.

Example:
    >>> from models import SERVO_KINDS
    >>> sorted(SERVO_KINDS)[:4]
    ['ax-12', 'ds3218', 'lx-16a', 'mg90']
"""


def make_named(name: str) -> str:
    """The name of a make, for whichever of its names, in small or capital letters."""
    return ALSO.get(name.lower(), name.lower())


def servo_of(name: str, given: Mapping[str, float] | None = None) -> ServoKind:
    """A make, or a pulse or bus servo of none, with numbers of a data sheet.

    Raises:
        ValueError: There is no such make, or a number is missing or impossible.
    """
    name, given = make_named(name), given or {}
    require_known("it", name, KNOWN_SERVOS)
    if missing := [n for n in OF_MOTOR if name in GENERIC and n not in given]:
        lacking = f"it has no {' and no '.join(missing)}"
        raise ValueError(f"{lacking}; give what its data sheet says")
    return KNOWN_SERVOS[name].with_numbers(given)
