"""The servos of a robot: on which channel each joint is, and its angle in counts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import degrees, inf, pi

import numpy as np

from models import SERVO_KINDS, Card, JointServo, ServoKind, description
from planner import Array
from sim.errors import UsageError
from sim.export.servo_commands import ServoCommands

FRAME = description.BOARD_COUNTS  # of a pulse and its pause
FRAMES = (24.0, 1526.0)  # that a PCA9685 can give in a second
TURN = 4096  # ticks of a Dynamixel in a turn, where nothing else is given
NEAR = 1e-9  # [rad]; beyond a limit, for rounding
PWM = SERVO_KINDS["mg90"]  # where no servo is named
PULSES = (300.0, 3000.0)  # [us] for the middle; hobby servos have 1500
BUS_NUMBERS = range(1, 254)  # ids of servos; a bus has other uses for 254 and 255


@dataclass(frozen=True, slots=True)
class Channel:
    """The servo of one joint with all its numbers; as `models.JointServo`."""

    joint: str
    channel: int
    sign: float
    center: float
    offset: float
    counts_per_radian: float
    low: float
    high: float

    def counts(self, angle: Array) -> Array:
        """Counts of angles, not rounded."""
        return self.center + self.sign * self.counts_per_radian * (angle - self.offset)

    def finer(self, times: float) -> "Channel":
        """The same servo in counts of which as many times more make an angle."""
        counts = times * self.counts_per_radian
        return replace(self, center=times * self.center, counts_per_radian=counts)

    def require_range(self, angles: Array) -> None:
        """Refuse angles beyond the range of the servo, with a UsageError."""
        for angle in (float(angles.min()), float(angles.max())):
            if not self.low - NEAR <= angle <= self.high + NEAR:
                raise _outside(self, angle, self.low, self.high)

    def angle(self, counts: Array) -> Array:
        """Angles of counts [rad]."""
        return self.offset + self.sign * (counts - self.center) / self.counts_per_radian


@dataclass(frozen=True, slots=True)
class ServoTable:
    """The servos of all joints, in the order of their channels."""

    channels: tuple[Channel, ...]  # one a joint
    largest: int  # count
    frame_rate: float = 0.0  # pulses a second; 0 for servos on a bus
    clock: float = description.BOARD_CLOCK  # of the board that gives them [Hz]
    microseconds: bool = False  # of a pulse instead of counts
    assumed: bool = False  # channels and senses of servos that nobody has described

    def __post_init__(self) -> None:
        for before, servo in pairwise(self.channels):
            if before.channel == servo.channel:
                joints = f"{before.joint!r} and {servo.joint!r}"
                facts = {"joints": joints, "channel": servo.channel}
                raise UsageError.of("one_channel", "the servo table", **facts)
        for servo in self.channels:
            if servo.counts_per_radian < 10.0:  # hobby servos have 100
                facts = {"joint": servo.joint, "angle": 1 / servo.counts_per_radian}
                raise UsageError.of("coarse_servo", "the servo table", **facts)
        most = 255 if self.frame_rate else BUS_NUMBERS[-1]  # 255: a byte of a header
        if self.channels and (servo := self.channels[-1]).channel > most:
            what = f"joint {servo.joint!r} is on channel {servo.channel}"
            raise UsageError(what, "the servo table", f"number them from 0 to {most}")

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of their channels."""
        return tuple(servo.joint for servo in self.channels)

    def in_microseconds(self) -> "ServoTable":
        """The same servos, commanded by the length of pulses instead of counts."""
        length, longest = 1e6 / (FRAME * self.frame_rate), round(1e6 / self.frame_rate)
        channels = tuple(servo.finer(length) for servo in self.channels)
        return replace(self, channels=channels, largest=longest - 1, microseconds=True)

    def counts(self, commands: ServoCommands) -> Array:
        """Whole counts of commands in the servos' range, by channel, (K, J)."""
        angles = self.require_range(commands)
        columns = [s.counts(angles[:, i]) for i, s in enumerate(self.channels)]
        counts: Array = np.round(np.stack(columns, axis=1)).astype(int)
        for servo, column in zip(self.channels, counts.T, strict=True):
            for end in (int(column.min()), int(column.max())):
                if not 0 <= end <= self.largest:
                    angle = float(servo.angle(np.array(float(end))))
                    ends = servo.angle(np.array([0.0, float(self.largest)]))
                    raise _outside(servo, angle, *sorted(ends.tolist()))
        return counts

    def commands(self, counts: Array, rate: float) -> ServoCommands:
        """The angles of counts, (K, J), in the order of the channels."""
        columns = [s.angle(counts[:, i]) for i, s in enumerate(self.channels)]
        return ServoCommands(self.joints, rate, np.stack(columns, axis=1))

    def require_range(self, commands: ServoCommands) -> Array:
        """Angles in the order of the channels, all within the servos' range, (K, J)."""
        order = [commands.joints.index(joint) for joint in self.joints]
        angles: Array = commands.angles[:, order]
        for servo, column in zip(self.channels, angles.T, strict=True):
            servo.require_range(column)
        return angles


def servo_table(
    card: Card,
    joints: Sequence[str],
    make: ServoKind | None,
    pwm: bool | None,
    given: Mapping[str, JointServo] | None = None,
    rate: float = 0.0,
) -> ServoTable:
    """The servos of a robot: those of its card, unless a table of others is given.

    Channels are in the order of the joints where none are given. Servos take pulses if
    `pwm`, ticks on a bus if not; None asks for their range alone, and servos of no make
    have none. The rate of commands is the frame rate of a PCA9685 and decides how long
    its counts are; 0, or a rate that it cannot have, leaves that of the make.
    """
    known = card.joint_servos if given is None else given
    on_bus = make is not None and make.signal == "bus"
    ours = pwm is False and given is None  # counts of the card, taken as ticks
    if ours and make and not on_bus:
        known = {  # whose counts are of pulses, and no ticks
            joint: replace(servo, center=None, counts_per_radian=None)
            for joint, servo in known.items()
        }
    elif ours and card.board_divider and known:
        raise UsageError.of("no_ticks", "the robot's card")
    if on_bus and pwm:
        for joint in joints:  # a bus gives no pulses, so theirs must be known
            servo = known.get(joint, JointServo())
            divider = given or card.board_divider  # which ticks do not have
            if not all((servo.counts_per_radian, servo.center, divider)):
                raise UsageError.of("bus", "the robot's card", joint=joint)
    if pwm is not None and (make is None or (make.signal == "pulse") != pwm):
        make = PWM if pwm else None
    if make and pwm and FRAMES[0] <= rate <= FRAMES[1]:
        make = make.at_rate(description.board_rate(rate, card.board_clock))
    if make and pwm and given is None:
        known = _in_frames(card, make)
    servos = [
        _channel(joint, number, known.get(joint, JointServo()), make, pwm)
        for number, joint in enumerate(joints)
    ]
    if make and pwm:
        _require_pulses(servos, make)
    ticks = 2 * make.center if make else TURN
    return ServoTable(
        channels=tuple(sorted(servos, key=lambda servo: servo.channel)),
        largest=(FRAME if pwm else max(ticks, TURN if given else 0)) - 1,
        frame_rate=make.command_rate if make and pwm else 0.0,
        clock=card.board_clock,
        assumed=any(known.get(j, JointServo()).channel is None for j in joints),
    )


def _require_pulses(servos: Sequence[Channel], make: ServoKind) -> None:
    """Refuse counts that are of no pulses, such as ticks of servos on a bus."""
    for servo in servos:
        pulse = servo.center * 1e6 / (FRAME * make.command_rate)
        if not PULSES[0] <= pulse <= PULSES[1]:
            facts = {"joint": servo.joint, "center": servo.center, "pulse": pulse}
            raise UsageError.of("no_pulse", "the servo table", **facts)


def _in_frames(card: Card, make: ServoKind) -> dict[str, JointServo]:
    """Servos of a card, their counts those of a make's frames, which may be longer."""
    now = description.board_divider(make.command_rate, card.board_clock)
    then, own = card.board_divider, card.servo
    if not then and own and own.made:
        built = description.servo_of(own.made, own.data)
        pulse, rate = built.signal == "pulse", built.command_rate
        then = description.board_divider(rate, card.board_clock) if pulse else now
    finer, found = (then or now) / now, {}
    for joint, servo in card.joint_servos.items():
        center, counts = servo.center, servo.counts_per_radian
        scaled = center and center * finer, counts and counts * finer
        found[joint] = replace(servo, center=scaled[0], counts_per_radian=scaled[1])
    return found


def _channel(
    joint: str, number: int, servo: JointServo, make: ServoKind | None, pwm: bool | None
) -> Channel:
    """The numbers of a servo that are given; its make, or a turn, gives the others."""
    reach = make.reach if make else (inf if pwm is None else pi)
    low, high = servo.limits or (servo.offset - reach, servo.offset + reach)
    middle, counts = make.center if make else TURN // 2, TURN / (2 * pi)
    if make and (make.resolution or pwm):
        counts = 1 / (make.resolution or 1.0)  # pulses without counts are refused
    center = middle if servo.center is None else servo.center
    channel = number if servo.channel is None else servo.channel
    counts = servo.counts_per_radian or counts
    return Channel(joint, channel, servo.sign, center, servo.offset, counts, low, high)


def require_limits(card: Card, commands: ServoCommands) -> None:
    """Refuse angles beyond the limits that a card has for servos, as far as it does."""
    for joint, servo in card.joint_servos.items():
        if servo.limits:
            column = commands.angles[:, commands.joints.index(joint)]
            _channel(joint, 0, servo, None, None).require_range(column)


def _outside(servo: Channel, angle: float, low: float, high: float) -> UsageError:
    facts = {"angle": angle, "degrees": degrees(angle), "low": low, "high": high}
    place = f"channel {servo.channel}"
    return UsageError.of("outside", place, joint=servo.joint, **facts)
