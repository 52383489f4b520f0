"""Makes of servo: their numbers stand in `makes.toml`, as data sheets have them."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi, radians
from typing import Any

from models.description.servos import BOARD_COUNTS, ServoKind
from planner.support import shipped_tables, unknown

KGF_CM = 0.0980665  # [N m]
SIXTY = pi / 3  # [rad]; data sheets give the time for 60 degrees
PULSES, BUS = 50.0, 100.0  # commands a second, the latter assumed where none is given
IN_COUNTS = {
    "dead_counts": "dead_band",
    "full_counts": "full_error",
    "profile_counts": "profile_speed",
}


def _kind(sheet: dict[str, Any]) -> ServoKind:
    """A servo from its table."""
    if "kgf_cm" in sheet:
        sheet["stall_torque"] = sheet.pop("kgf_cm") * KGF_CM
        sheet["no_load_speed"] = SIXTY / sheet.pop("seconds")
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
GENERIC = ("pulse", "bus")
"""Servos of no make, to which a data sheet gives torque and speed at least."""
SERVO_KINDS = {n: kind for n, kind in KNOWN_SERVOS.items() if n not in GENERIC}
"""Servos by name.

Example:
    >>> from models import SERVO_KINDS
    >>> sorted(SERVO_KINDS)[:4]
    ['ax-12', 'ds3218', 'lx-16a', 'mg90']
"""
NEEDED = ("stall_torque", "no_load_speed")


def servo_of(name: str, given: Mapping[str, float] | None = None) -> ServoKind:
    """A make, or a pulse or bus servo of none, with numbers of a data sheet.

    Raises:
        ValueError: There is no such make, or a number is missing or impossible.

    Example:
        >>> from models.description import servo_of
        >>> servo_of("pulse", {"stall_torque": 1.0, "no_load_speed": 6.0}).signal
        'pulse'
    """
    name, given = ALSO.get(name.lower(), name.lower()), given or {}
    if name not in KNOWN_SERVOS:
        raise ValueError(f"it {unknown(name, KNOWN_SERVOS)}")
    if missing := [n for n in NEEDED if name in GENERIC and n not in given]:
        lacking = f"it has no {' and no '.join(missing)}"
        raise ValueError(f"{lacking}; give what its data sheet says")
    return KNOWN_SERVOS[name].with_numbers(given)
