"""The robot card: which parts of an MJCF file are legs, joints, feet and groups.

Reads and validates the TOML file beside a robot's MJCF. Whether the named parts exist
is for `models.robot` to say.
"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any

from models.errors import ModelError


@dataclass(frozen=True, slots=True)
class LegCard:
    """The joints and ground-touching geoms of one leg."""

    swing: str  # joint
    lift: str  # joint
    foot: tuple[str, ...]  # geoms
    raise_sign: int = 1  # sign of the lift joint that raises the foot
    hold: Mapping[str, float] = field(default_factory=dict)  # joint -> angle [rad]

    def __post_init__(self) -> None:
        if self.raise_sign not in (-1, 1):
            raise ValueError(f"raise must be 1 or -1, got {self.raise_sign}")
        if not self.foot:
            raise ValueError("foot names no geom")
        if self.swing == self.lift:
            raise ValueError(f"swing and lift are the same joint, {self.swing}")


@dataclass(frozen=True, slots=True)
class GroupCard:
    """Legs that swing by one angle and lift together."""

    legs: Mapping[int, int]  # leg -> sign of its swing joint for a positive angle
    twist: tuple[float, float, float] | None = None  # claimed, per radian of swing

    def __post_init__(self) -> None:
        if not self.legs:
            raise ValueError("a group needs at least one leg")
        if bad := {leg: s for leg, s in self.legs.items() if s not in (-1, 1)}:
            raise ValueError(f"signs of legs must be 1 or -1, got {bad}")


@dataclass(frozen=True, slots=True)
class Servo:
    """Position servo for joints that have none of their own."""

    stiffness: float  # [N m/rad]
    damping: float  # [N m s/rad]

    def __post_init__(self) -> None:
        if not (isfinite(self.stiffness) and self.stiffness > 0):
            raise ValueError(f"stiffness must be positive, got {self.stiffness}")
        if not (isfinite(self.damping) and self.damping >= 0):
            raise ValueError(f"damping must not be negative, got {self.damping}")


@dataclass(frozen=True, slots=True)
class Card:
    """Everything the testbed must be told about a robot."""

    lift_angle: float  # [rad], clears the ground
    legs: Mapping[int, LegCard]
    groups: Mapping[str, GroupCard]
    gait: tuple[str, ...]  # strata, each the names of the groups in contact
    servo: Servo | None = None
    description: str = ""

    def __post_init__(self) -> None:
        if not (isfinite(self.lift_angle) and self.lift_angle > 0):
            raise ValueError(f"lift_angle must be positive, got {self.lift_angle}")
        self._check_groups()
        self._check_gait()

    def _check_groups(self) -> None:
        grouped = [leg for group in self.groups.values() for leg in group.legs]
        if sorted(grouped) != sorted(self.legs):
            raise ValueError(
                f"groups hold legs {sorted(grouped)}, but the robot has legs "
                f"{sorted(self.legs)}; every leg belongs to exactly one group"
            )
        if long := [name for name in self.groups if len(name) != 1]:
            raise ValueError(f"names of groups are one character each, got {long}")

    def _check_gait(self) -> None:
        if len(self.gait) < 2 or self.gait[0] != self.gait[-1]:
            raise ValueError(f"gait {list(self.gait)} does not close, eq. (11)")
        for stratum in self.gait:
            if unknown := set(stratum) - set(self.groups):
                raise ValueError(f"stratum {stratum!r} names no group {unknown}")

    @property
    def bottom(self) -> str:
        """The stratum with every group in contact."""
        return "".join(self.groups)


def read_card(path: Path) -> Card:
    """Read a robot card.

    Args:
        path: TOML file in the format of the README's section on robots.

    Raises:
        ModelError: If the file is not TOML, or says something impossible.
    """
    try:
        table = tomllib.loads(path.read_text())
        return _decode(table)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, ValueError, TypeError) as error:
        raise ModelError(f"bad robot card: {path}; {error}") from error


def _decode(table: dict[str, Any]) -> Card:
    known = {"lift_angle", "leg", "group", "gait", "servo", "description"}
    _refuse_unknown(table, known, "the card")
    for key in ("lift_angle", "leg", "group", "gait"):
        if key not in table:
            raise ValueError(f"{key} is missing")
    servo = table.get("servo")
    return Card(
        lift_angle=float(table["lift_angle"]),
        legs={int(number): _leg(number, leg) for number, leg in table["leg"].items()},
        groups={name: _group(name, group) for name, group in table["group"].items()},
        gait=tuple(_strata(table["gait"])),
        servo=None if servo is None else Servo(**servo),
        description=table.get("description", ""),
    )


def _strata(table: dict[str, Any]) -> list[str]:
    _refuse_unknown(table, {"strata"}, "gait")
    if "strata" not in table:
        raise ValueError("gait: strata is missing")
    return list(table["strata"])


def _leg(number: str, table: dict[str, Any]) -> LegCard:
    where = f"leg.{number}"
    _refuse_unknown(table, {"swing", "lift", "raise", "foot", "hold"}, where)
    try:
        return LegCard(
            swing=table["swing"],
            lift=table["lift"],
            foot=tuple(table["foot"]),
            raise_sign=table.get("raise", 1),
            hold=table.get("hold", {}),
        )
    except KeyError as error:
        raise ValueError(f"{where}: {error.args[0]} is missing") from error
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error


def _group(name: str, table: dict[str, Any]) -> GroupCard:
    where = f"group.{name}"
    _refuse_unknown(table, {"legs", "twist"}, where)
    if "legs" not in table:
        raise ValueError(f"{where}: legs is missing")
    twist = table.get("twist")
    try:
        return GroupCard(
            legs={int(leg): sign for leg, sign in table["legs"].items()},
            twist=None if twist is None else _twist(twist),
        )
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error


def _twist(values: list[float]) -> tuple[float, float, float]:
    if len(values) != 3 or not all(isfinite(v) for v in values):
        raise ValueError(f"twist is forward, left [m/rad], yaw [rad/rad]; got {values}")
    return (float(values[0]), float(values[1]), float(values[2]))


def _refuse_unknown(table: dict[str, Any], known: set[str], where: str) -> None:
    for key in table.keys() - known:
        near = difflib.get_close_matches(key, known, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"known are {sorted(known)}"
        raise ValueError(f"{where} has no key {key!r}; {hint}")
