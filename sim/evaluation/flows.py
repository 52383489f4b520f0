"""The phases of a walk as they were carried out, and flows.csv, which lists them."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple


class WalkedPhase(NamedTuple):
    """A phase as it was carried out: one line of flows.csv."""

    segment: int
    start: float  # [s]
    end: float  # [s]
    kind: str  # hold, lift, swing or land
    stratum: str  # groups in contact throughout
    field: str  # of a swing
    amount: float  # [rad]
    group: str  # that move; empty in a hold
    slip: float  # of all feet [m]
    as_planned: bool  # contacts


COLUMNS = ("index", *WalkedPhase._fields)
READ: tuple[Callable[[str], Any], ...] = (
    int,
    float,
    float,
    str,
    str,
    str,
    float,
    str,
    float,
    "1".__eq__,
)


def written(phases: Iterable[WalkedPhase]) -> str:
    """The text of flows.csv: one line a phase."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(COLUMNS)
    for index, phase in enumerate(phases):
        writer.writerow((index, *phase[:-1], int(phase.as_planned)))
    return lines.getvalue()


def read(text: str) -> tuple[WalkedPhase, ...]:
    """The phases that a text of `written` lists, its columns in any order.

    Raises:
        KeyError: If a column is missing.
        ValueError: If a line has more or fewer entries than there are columns.
    """
    lines = [line for line in csv.reader(text.splitlines()) if line]
    if len({len(line) for line in lines}) != 1:
        raise ValueError("flows.csv is incomplete")
    rows = (dict(zip(lines[0], line, strict=True)) for line in lines[1:])
    names = WalkedPhase._fields
    return tuple(
        WalkedPhase(*(as_type(row[n]) for n, as_type in zip(names, READ, strict=True)))
        for row in rows
    )
