"""The phases of a walk as they were carried out, and flows.csv, which lists them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from math import isfinite
from typing import NamedTuple


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

    A missing column is a KeyError, a line with more or fewer entries than there are
    columns a ValueError.
    """
    lines = [line for line in csv.reader(text.splitlines()) if line]
    if len({len(line) for line in lines}) != 1:
        raise ValueError("flows.csv is incomplete")
    phases = tuple(
        WalkedPhase(
            segment=int(row["segment"]),
            start=float(row["start"]),
            end=float(row["end"]),
            kind=row["kind"],
            stratum=row["stratum"],
            field=row["field"],
            amount=float(row["amount"]),
            group=row["group"],
            slip=float(row["slip"]),
            as_planned=row["as_planned"] == "1",
        )
        for row in (dict(zip(lines[0], line, strict=True)) for line in lines[1:])
    )
    numbers = [number for p in phases for number in (p.start, p.end, p.amount, p.slip)]
    if not all(map(isfinite, numbers)):
        raise ValueError("flows.csv has a number that is not finite")
    return phases
