"""Read a robot card from TOML, be it a file or part of one."""

from __future__ import annotations

import difflib
import tomllib
from math import isfinite
from pathlib import Path
from typing import Any

from models.card import Card, GroupCard, LeanCard, LegCard, PatternCard, Servo, Twist
from models.errors import ModelError

NEEDED = ("lift_angle", "leg", "group", "gait")
OPTIONAL = ("pattern", "lean", "servo", "description")


def read_card(path: Path) -> Card:
    """Read the card in a TOML file.

    Raises:
        ModelError: If the file is not TOML, or says something impossible.
    """
    return parse_card(read_text(path), str(path))


def read_text(path: Path) -> str:
    """Text of a card's file.

    Raises:
        ModelError: If it is no text.
    """
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ModelError(f"bad robot card: {path}; not text, {error}") from error


def parse_card(text: str, source: str) -> Card:
    """Read a robot card.

    Args:
        text: TOML in the format of the README's section on robots.
        source: Where it stands, for refusals.

    Raises:
        ModelError: If it is not TOML, or says something impossible.
    """
    try:
        return _decode(tomllib.loads(text))
    except (ValueError, TypeError) as error:
        raise ModelError(f"bad robot card: {source}; {error}") from error


def _decode(table: dict[str, Any]) -> Card:
    _refuse_unknown(table, {*NEEDED, *OPTIONAL}, "the card")
    for key in NEEDED:
        if key not in table:
            raise ValueError(f"{key} is missing")
    servo = table.get("servo")
    return Card(
        lift_angle=float(table["lift_angle"]),
        legs={int(number): _leg(number, leg) for number, leg in table["leg"].items()},
        groups={name: _group(name, group) for name, group in table["group"].items()},
        gait=tuple(_strata(table["gait"])),
        patterns={
            name: _pattern(name, pattern)
            for name, pattern in table.get("pattern", {}).items()
        },
        leans={name: _lean(name, lean) for name, lean in table.get("lean", {}).items()},
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
    try:
        return GroupCard(
            legs={int(leg): float(gain) for leg, gain in table["legs"].items()},
            twist=_twist(table.get("twist")),
        )
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error


def _pattern(name: str, table: dict[str, Any]) -> PatternCard:
    where = f"pattern.{name}"
    _refuse_unknown(table, {"strata", "groups", "twist"}, where)
    try:
        return PatternCard(
            strata=tuple(table["strata"]),
            groups={group: float(gain) for group, gain in table["groups"].items()},
            twist=_twist(table.get("twist")),
        )
    except KeyError as error:
        raise ValueError(f"{where}: {error.args[0]} is missing") from error
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error


def _lean(stratum: str, table: dict[str, Any]) -> LeanCard:
    where = f"lean.{stratum}"
    _refuse_unknown(table, {"pattern", "groups", "at"}, where)
    try:
        return LeanCard(table["pattern"], tuple(table["groups"]), float(table["at"]))
    except KeyError as error:
        raise ValueError(f"{where}: {error.args[0]} is missing") from error
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error


def _twist(values: list[float] | None) -> Twist | None:
    if values is None:
        return None
    if len(values) != 3 or not all(isfinite(v) for v in values):
        raise ValueError(f"twist is forward, left [m/rad], yaw [rad/rad]; got {values}")
    return (float(values[0]), float(values[1]), float(values[2]))


def _refuse_unknown(table: dict[str, Any], known: set[str], where: str) -> None:
    for key in table.keys() - known:
        near = difflib.get_close_matches(key, known, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"known are {sorted(known)}"
        raise ValueError(f"{where} has no key {key!r}; {hint}")
