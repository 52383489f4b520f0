"""The phases of a walk as they were carried out, and flows.csv, which lists them."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable
from math import isfinite
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


KINDS: dict[str, Callable[[str], Any]] = {  # of the columns
    **dict.fromkeys(WalkedPhase._fields, str),
    **dict.fromkeys(("start", "end", "amount", "slip"), float),
    "segment": int,
    "as_planned": lambda text: text == "1",
}
COLUMNS = ("index", *WalkedPhase._fields)


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

    A missing column is a KeyError, other errors of a line are ValueErrors.
    """
    lines = [line for line in csv.reader(text.splitlines()) if line]
    if len({len(line) for line in lines}) != 1:
        raise ValueError("flows.csv is incomplete")
    rows = (dict(zip(lines[0], line, strict=True)) for line in lines[1:])
    phases = tuple(
        WalkedPhase(*(kind(row[key]) for key, kind in KINDS.items())) for row in rows
    )
    numbers = [number for p in phases for number in (p.start, p.end, p.amount, p.slip)]
    if not all(map(isfinite, numbers)):
        raise ValueError("flows.csv has a number that is not finite")
    return phases
