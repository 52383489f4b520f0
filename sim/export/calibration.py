"""Where the servos of a robot are and how they stand, found one servo at a time.

A servo is jogged; its owner says which joint moved, which way, and at which count it
stood at two marked angles. From that follow channel, sign, centre and counts a radian.
They are counts of the divider that the sketch gives its board; with a clock that was
measured, boards divide by what suits it, and counts are longer or shorter.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import degrees, radians

import numpy as np

from models import JointServo, Kinematics, Robot, ServoKind
from models.description import board_divider, toml_key
from planner import Array
from sim.export.servo_commands import ServoCommands

MARK = radians(30)  # of a joint from where it stands, on either side
LIKELY = 0.5  # of the counts a radian of the make; other answers are mistaken
SWING, SECONDS = radians(15), 2.0  # of the strokes that check
WAYS = {"+": 1, "-": -1}
NUMBERS = ("channel", "sign", "center", "offset", "counts_per_radian")
OWN = re.compile(r"[ \t]*\[(servo\.|board\])")


def joint_servo(
    kind: ServoKind,
    clock: float,
    channel: int,
    turned: str,
    counts: tuple[int, int],
    angles: tuple[float, float],
) -> JointServo:
    """The servo of a joint that stood at two counts at two angles [rad].

    It turned from the first to the second as counts grew, `+`, or back, `-`. Answers
    that cannot be are a ValueError, which says what to look at.
    """
    if turned not in WAYS:
        raise ValueError(f"it turned + or -, not {turned!r}")
    (first, second), apart = counts, angles[1] - angles[0]
    if (second - first) * WAYS[turned] <= 0:
        raise ValueError(
            f"it turned {turned} as counts grew, and counts go from {first} to "
            f"{second}; look at the marks again"
        )
    needed, likely = abs(second - first), apart / kind.resolution
    if not LIKELY < needed / likely < 1 / LIKELY:
        raise ValueError(
            f"{needed} counts for {degrees(apart):.0f} degrees, and its make takes "
            f"{likely:.0f}; look at the marks again"
        )
    longer, rate = 1.0, kind.command_rate
    if kind.signal == "pulse":
        longer = board_divider(rate, clock) / board_divider(rate)
    return JointServo(
        channel=channel,
        sign=WAYS[turned],
        center=(first + second) / 2 / longer,
        offset=sum(angles) / 2,
        counts_per_radian=needed / apart / longer,
    )


def marks(robot: Robot, joint: str) -> tuple[float, float]:
    """Two angles of a joint that are far apart and within its range [rad]."""
    stands, (low, high) = robot.standing_angle(joint), robot.span(joint)
    return max(stands - MARK, low), min(stands + MARK, high)


def card_with(text: str, servos: Mapping[str, JointServo], clock: float | None) -> str:
    """A card's text with the servos of joints, in place of what it said of any.

    So it is with the clock of the board, if it was measured.
    """
    tables = re.split(r"^(?=[ \t]*\[)", text, flags=re.M)
    lines = ["".join(table for table in tables if not OWN.match(table)).rstrip()]
    if clock is not None:
        lines += ["", "[board]", f"clock = {clock:.0f}  # [Hz], measured"]
    for joint, servo in servos.items():
        lines += ["", f"[servo.{toml_key(joint)}]"]
        numbers = ((name, getattr(servo, name)) for name in NUMBERS)
        lines += [
            f"{name} = {value:.8g}" for name, value in numbers if value is not None
        ]
        lines += [f"limits = {list(servo.limits)}"] if servo.limits else []
    return "\n".join([*lines, ""])


def strokes(robot: Robot, rate: float) -> tuple[ServoCommands, dict[str, str]]:
    """Three strokes that show servos mounted or numbered wrongly, and what to see.

    All legs turn anticlockwise and back; all feet rise and come down; the feet rise one
    after another and come down on their rings of the printed sheet.
    """
    joints, kinematics = robot.card.joints, Kinematics(robot)
    rest = np.array([robot.standing_angle(joint) for joint in joints])
    turn, rise = np.zeros(len(joints)), np.zeros((len(robot.legs), len(joints)))
    for number, leg in enumerate(robot.leg_cards):
        swing = joints.index(leg.swing)
        room = min(abs(end - rest[swing]) for end in robot.span(leg.swing))
        turn[swing] = np.sign(kinematics.axis(leg.swing)[2]) * min(SWING, room)
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
    slope = np.linspace(0, 1, round(SECONDS * rate))
    flat = np.ones_like(slope)
    return np.concatenate([slope, flat, slope[::-1], 0 * flat])
