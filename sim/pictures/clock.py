"""The clock of a film: the moment that each picture shows, and the playback speed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

import numpy as np

from planner import Array
from sim.pictures.style import FRAME_RATE, LONGEST, TAIL


@dataclass(frozen=True)
class Clock:
    """The pictures of a film in order.

    Attributes:
        playback: Speed against real time.
        rows: Row of the trajectory that each picture shows, shape (pictures,).
    """

    playback: float
    rows: Array

    def frame_of(self, rows: Array) -> Array:
        """First picture that shows each row or a later one, shape as given."""
        return np.searchsorted(self.rows, rows)


def clock(time: Array, playback: float | None = None) -> Clock:
    """Spread the pictures evenly over a walk, and hold the last one for a moment.

    Args:
        time: Of each row of the trajectory, ascending, shape (T,) [s].
        playback: Speed against real time; None takes the lowest round one, real time
            at best, that keeps the film within `LONGEST`.
    """
    duration = float(time[-1] - time[0])
    if playback is None:
        playback = next(p for p in _round_speeds() if duration / p <= LONGEST - TAIL)
    moving = int(duration / playback * FRAME_RATE)
    moments = time[0] + np.arange(moving) * playback / FRAME_RATE
    last = np.full(round(TAIL * FRAME_RATE), len(time) - 1)
    return Clock(playback, np.concatenate([np.searchsorted(time, moments), last]))


def _round_speeds() -> Iterator[float]:
    """1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, ... 60, 80, 100, ..."""
    yield from (1, 2, 3, 4, 5, 6, 8)
    for power in count(1):
        yield from (
            digit * 10.0**power for digit in (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8)
        )
