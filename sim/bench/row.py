"""Measurements: one row each, times as medians, ratios from interleaved pairs.

Interleaving affects both sides of a ratio alike if the machine changes its speed. A
slow machine is not an error; nothing is judged here.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

REPEATS = 5


@dataclass(frozen=True, slots=True)
class Row:
    """One measurement."""

    what: str
    value: float
    unit: str
    wanted: str | None = None

    def __str__(self) -> str:
        measured = f"{self.what:58}{self.value:12.4g} {self.unit:8}"
        return f"{measured} wanted {self.wanted}" if self.wanted else measured.rstrip()


def paired(
    other: Callable[[], object], ours: Callable[[], object]
) -> tuple[float, float]:
    """Median of other / ours over interleaved pairs, and that of our time [s]."""
    times = [(seconds(other), seconds(ours)) for _ in range(REPEATS)]
    ratios = [a / b for a, b in times]
    return statistics.median(ratios), statistics.median(b for _, b in times)


def median(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median time of some work after one warm-up [s]."""
    work()
    return statistics.median(seconds(work) for _ in range(repeats))


def seconds(work: Callable[[], object]) -> float:
    """Time that some work takes [s]."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began
