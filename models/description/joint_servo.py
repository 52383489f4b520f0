"""How the servo of one joint is connected and calibrated, as a card says it.

The count that a servo is told for a joint's angle is

    center + sign * counts_per_radian * (angle - offset),

so `offset` is the joint's angle at which the servo stands at its centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from models.description.table import Table

KEYS = ("channel", "sign", "center", "offset", "counts_per_radian", "limits")


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
    """

    channel: int | None = None
    sign: float = 1
    center: float | None = None
    offset: float = 0.0
    counts_per_radian: float | None = None
    limits: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.channel is not None and self.channel < 0:
            raise ValueError(f"channel must not be negative, got {self.channel}")
        if self.sign not in (-1, 1):
            raise ValueError(f"sign must be 1 or -1, got {self.sign:g}")
        if not isfinite(self.offset):
            raise ValueError(f"offset must be finite, got {self.offset}")
        if self.center is not None and not (isfinite(self.center) and self.center >= 0):
            raise ValueError(f"center must not be negative, got {self.center}")
        counts = self.counts_per_radian
        if counts is not None and not (isfinite(counts) and counts > 0):
            raise ValueError(f"counts_per_radian must be positive, got {counts}")
        if self.limits is not None and not _is_range(self.limits):
            raise ValueError(
                f"limits are the lowest and the highest angle, got {list(self.limits)}"
            )


def _is_range(limits: tuple[float, ...]) -> bool:
    return len(limits) == 2 and all(map(isfinite, limits)) and limits[0] < limits[1]


def read_joint_servo(table: Table) -> JointServo:
    """The servo in a card's table `[servo.JOINT]`.

    Raises:
        ValueError: A value is of the wrong kind, or impossible.
    """
    given: dict[str, object] = {}
    if "channel" in table:
        given["channel"] = table.whole("channel")
    for key in ("sign", "center", "offset", "counts_per_radian"):
        if key in table:
            given[key] = table.number(key)
    if "limits" in table:
        given["limits"] = table.numbers("limits")
    return table.make(JointServo, **given)
