"""The phases of a walk as they were carried out, and flows.csv, which lists them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import pi
from typing import Any, NamedTuple, get_args, get_type_hints

import numpy as np

from models import Card
from planner import Array
from sim.folder import csv_rows, csv_text
from sim.motion.schedule import Kind


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


KINDS: dict[str, Callable[[str], Any]]  # readers of the columns
KINDS = get_type_hints(WalkedPhase) | {
    "as_planned": lambda text: bool(["0", "1"].index(text))
}
COLUMNS = ("index", *WalkedPhase._fields)
LARGEST = 1e9  # number, and more segments than any walk has
MOMENT = 1e-5  # of a second, and of the walk: models keep six digits of a timestep
FARTHEST = 4 * pi  # [rad] that a joint of a leg moves in a phase


def written(phases: Iterable[WalkedPhase]) -> str:
    """The text of flows.csv: one line a phase."""
    rows = ((i, *p[:-1], int(p.as_planned)) for i, p in enumerate(phases))
    return csv_text([COLUMNS, *rows])


def read(text: str) -> tuple[WalkedPhase, ...]:
    """The phases that a text of `written` lists, its columns in any order.

    A missing column is a KeyError, other errors of a line are ValueErrors.
    """
    rows = csv_rows(text, "flows.csv")
    if [row["index"] for row in rows] != [*map(str, range(len(rows)))]:
        raise ValueError("flows.csv does not number its phases from 0")
    phases = tuple(map(_phase, rows))
    if not phases:
        raise ValueError("flows.csv lists no phase")
    numbers = [number for p in phases for number in (p.start, p.end, p.amount, p.slip)]
    if not all(abs(number) < LARGEST for number in numbers):
        raise ValueError(f"flows.csv has a number that is not below {LARGEST:g}")
    if strange := {p.kind for p in phases}.difference(get_args(Kind)):
        raise ValueError(f"flows.csv has a phase of kind {min(strange)[:20]!r}")
    if any(p.end - p.start < 0.5e-6 for p in phases):  # [s]; a step is longer
        raise ValueError("flows.csv has a phase that takes no time")
    moments = [moment for p in phases for moment in (p.start, p.end)]
    segments = [0, *(p.segment for p in phases)]
    if moments != sorted(moments) or segments != sorted(segments):
        raise ValueError("flows.csv has phases out of their order")
    return phases


def _phase(row: Mapping[str, str]) -> WalkedPhase:
    try:
        return WalkedPhase(*(kind(row[key]) for key, kind in KINDS.items()))
    except ValueError as error:
        raise ValueError(f"phase {row['index']} of flows.csv, {error}") from error


def require_known(phases: Iterable[WalkedPhase], card: Card) -> None:
    """Refuse, with a ValueError, what no walk of a card's robot does."""
    groups, legs = [*card.groups], ["legs", *map(str, sorted(card.legs))]
    known = {*groups, *card.patterns}
    gains = [abs(g) for group in card.groups.values() for g in group.legs.values()]
    shares = [abs(g) for one in card.patterns.values() for g in one.groups.values()]
    most = FARTHEST / min(1.0, *gains) / min([1.0, *shares])
    for p in phases:
        stands = _some(p.stratum, groups) or _some(p.stratum.split(" "), legs)
        own = p.field.removeprefix(f"g{p.stratum}_")
        swings = not p.field or (p.kind == "swing" and own != p.field and own in known)
        if not (stands and swings and _some(p.group, groups) and abs(p.amount) <= most):
            line = ",".join(map(str, p))
            raise ValueError(f"flows.csv has what its robot does not do, {line[:80]}")


def require_times(
    phases: Sequence[WalkedPhase],
    phase: Array,
    time: Array,
    commanded: Array,
    timestep: float,
) -> None:
    """Refuse, with a ValueError, rows at times other than those of their phases.

    Rows are in phases of numbers (T,) at times (T,), commands at (N,), one a step [s].
    """
    start, end = np.array([(p.start, p.end) for p in phases])[phase].T
    whole = phases[-1].end
    late, last, near = time - end, whole - time[-1], MOMENT * (1 + whole)
    if max((start - time).max(), late.max(), last) > near:
        raise ValueError("trajectory.npz has not the times of flows.csv")
    clock = np.linspace(0.0, whole, len(commanded) + 1)
    odd = np.abs(np.append(commanded, whole) - clock).max() > near
    if odd or abs(len(commanded) * timestep - whole) > timestep + near:
        raise ValueError("commands.npz has not the times of flows.csv")


def _some(names: Iterable[str], known: Iterable[str]) -> bool:
    """Whether names are some of those that are known, in their order."""
    rest = iter(known)
    return all(name in rest for name in names)
