"""Where the servos of a robot are and how they stand, found one servo at a time.

A servo is jogged; its owner says which joint moved, which way, and at which count it
stood at two marked angles. From that follow channel, sign, centre and counts a radian,
and from a pulse that is measured the clock of the board. Answers are kept in a file of
TOML, with which the work goes on later.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, radians

import numpy as np

from models import JointServo, Kinematics, Robot, ServoKind
from models.description import Table, board_divider, parse_toml, toml_key
from planner import Array
from sim.export.servo_commands import ServoCommands

MARK = radians(30)  # of a joint from where it stands, on either side
LIKELY = 0.5  # of the counts a radian of the make; other answers are mistaken
SWING, SECONDS = radians(15), 2.0  # of the strokes that check
WAYS = {"+": 1, "-": -1}


@dataclass(frozen=True)
class Answer:
    """What the owner saw of the servo of one joint.

    A ValueError says what cannot be, and what to look at.
    """

    channel: int
    turned: str  # from mark 1 to mark 2 as counts grew, +, or back, -
    counts: tuple[int, int]  # at the marks

    def __post_init__(self) -> None:
        if self.turned not in WAYS:
            raise ValueError(f"it turned + or -, not {self.turned!r}")
        first, second = self.counts
        if (second - first) * WAYS[self.turned] <= 0:
            raise ValueError(
                f"it turned {self.turned} as counts grew, and counts go from {first} "
                f"to {second}; look at the marks again"
            )

    def servo(self, marks: tuple[float, float], scale: float = 1.0) -> JointServo:
        """The servo's numbers on a card, whose counts are longer by a scale."""
        first, second = (count / scale for count in self.counts)
        return JointServo(
            channel=self.channel,
            sign=WAYS[self.turned],
            center=(first + second) / 2,
            offset=sum(marks) / 2,
            counts_per_radian=abs(second - first) / (marks[1] - marks[0]),
        )


@dataclass(frozen=True)
class Answers:
    """Those of some joints, and the board's clock if it was measured [Hz]."""

    joints: Mapping[str, Answer]
    clock: float | None = None

    def __str__(self) -> str:
        lines = [f"clock = {self.clock:.0f}"] if self.clock else []
        for joint, one in self.joints.items():
            lines += [f"\n[servo.{toml_key(joint)}]", f"channel = {one.channel}"]
            lines += [f'turned = "{one.turned}"', f"counts = {list(one.counts)}"]
        return "\n".join([*lines, ""])


def read_answers(text: str) -> Answers:
    """The answers in a file; a ValueError if they are none."""
    table = Table(parse_toml(text), known=("clock", "servo"))
    found = {}
    for joint, one in table.table("servo").values.items():
        known = Table(one, f"servo.{joint}", ("channel", "turned", "counts"))
        first, second = map(round, known.numbers("counts"))
        found[joint] = known.make(
            Answer,
            channel=known.whole("channel"),
            turned=known.text("turned"),
            counts=(first, second),
        )
    return Answers(found, table.number("clock") if "clock" in table else None)


def marks(robot: Robot, joint: str) -> tuple[float, float]:
    """Two angles of a joint that are far apart and within its range [rad]."""
    stands, (low, high) = robot.standing_angle(joint), robot.span(joint)
    return max(stands - MARK, low), min(stands + MARK, high)


def require_likely(answer: Answer, apart: float, kind: ServoKind) -> None:
    """Refuse counts that no servo of the make would need from mark to mark."""
    first, second = answer.counts
    ratio = abs(second - first) / apart * kind.resolution
    if not LIKELY < ratio < 1 / LIKELY:
        raise ValueError(
            f"{abs(second - first)} counts for {degrees(apart):.0f} degrees, and its "
            f"make takes {apart / kind.resolution:.0f}; look at the marks again"
        )


def card_with(text: str, robot: Robot, answers: Answers, kind: ServoKind) -> str:
    """A card's text with the servos of the joints, in place of what it said of them.

    Counts are those of the sketch's divider; with a clock that was measured, boards
    divide by what suits it.
    """
    kept, clock = _without_servos(text).rstrip(), answers.clock
    lines, scale = [kept], 1.0
    if kind.signal == "pulse" and clock:
        lines += ["", "[board]", f"clock = {clock:.0f}  # [Hz], measured"]
        rate = kind.command_rate
        scale = board_divider(rate, clock) / board_divider(rate)
    for joint, answer in answers.joints.items():
        servo = answer.servo(marks(robot, joint), scale)
        lines += ["", f"[servo.{toml_key(joint)}]", f"channel = {servo.channel}"]
        numbers = ("sign", "center", "offset", "counts_per_radian")
        lines += [f"{name} = {getattr(servo, name):.8g}" for name in numbers]
    return "\n".join([*lines, ""])


def _without_servos(text: str) -> str:
    """A card without the tables of single servos and of the board."""
    tables = re.split(r"^(?=[ \t]*\[)", text, flags=re.M)
    own = re.compile(r"[ \t]*\[(servo\.|board\])")
    return "".join(table for table in tables if not own.match(table))


def strokes(robot: Robot, rate: float) -> tuple[ServoCommands, dict[str, str]]:
    """Three strokes that show servos mounted or numbered wrongly, and what to see.

    All legs turn anticlockwise and back; all feet rise and come down; the feet rise one
    after another and come down on their rings of the printed sheet.
    """
    joints, kinematics = robot.card.joints, Kinematics(robot)
    rest = np.array([robot.standing_angle(joint) for joint in joints])
    turn, rise = np.zeros(len(joints)), np.zeros((len(robot.legs), len(joints)))
    for number, leg in enumerate(robot.leg_cards):
        room = min(
            abs(end - rest[joints.index(leg.swing)]) for end in robot.span(leg.swing)
        )
        sense = np.sign(kinematics.axis(leg.swing)[2])
        turn[joints.index(leg.swing)] = sense * min(SWING, room)
        rise[number, joints.index(leg.lift)] = leg.raise_sign * robot.card.lift_angle
    moves = [turn, rise.sum(axis=0), *rise]
    angles = np.concatenate([rest + move * _bump(rate)[:, None] for move in moves])
    each = len(angles) / len(moves) / rate
    told = {
        f"0 to {each:.0f} s": "every leg turns anticlockwise, seen from above, and "
        "back; one that turns the other way has a wrong sign",
        f"to {2 * each:.0f} s": "every foot rises and comes down; one that pushes "
        "has a wrong sign",
        f"to {len(moves) * each:.0f} s": "feet rise in the order of their legs and "
        "come down on their rings, which are a degree wide",
    }
    return ServoCommands(tuple(joints), rate, angles), told


def _bump(rate: float) -> Array:
    """From 0 to 1, a while, back to 0, a while; in `SECONDS` each."""
    count = round(SECONDS * rate)
    slope, flat = np.linspace(0, 1, count), np.ones(count)
    bump: Array = np.concatenate([slope, flat, slope[::-1], 0 * flat])
    return bump
