"""The clocks of film and viewer: the moment that is shown, and the playback speed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from math import inf

import numpy as np

from planner import Array
from sim.errors import UsageError

FRAME_RATE = 25  # [1/s]
MOST_PICTURES = 100_000  # an hour
FILM_LENGTH = 40.0  # [s] at most, unless a scenario sets the playback speed itself
TAIL = 1.5  # [s] that the last picture stays

Stretch = tuple[float, float]
WHOLE: Stretch = (-inf, inf)


@dataclass(frozen=True)
class Clock:
    """The pictures of a film in order."""

    playback: float  # speed against real time
    rows: Array  # of the trajectory, that each picture shows, (pictures,)

    @property
    def moving(self) -> int:
        """Number of pictures before the last one is held."""
        return int(np.searchsorted(self.rows, self.rows[-1]))

    def frame_of(self, rows: Array) -> Array:
        """First picture that shows each row or a later one, shape as given."""
        return np.searchsorted(self.rows, rows)


def clock(
    time: Array, playback: float | None = None, stretch: Stretch = WHOLE
) -> Clock:
    """Spread the pictures evenly over a walk, and hold the last one for a moment.

    Without a playback speed, take the lowest round one, real time at best, that keeps
    the film within `FILM_LENGTH`.
    """
    first, last = rows_of(time, stretch)
    duration = float(time[last] - time[first])
    if playback is None:
        fast = (p for p in _round_speeds() if duration / p <= FILM_LENGTH - TAIL)
        playback = next(fast)
    if (moving := int(duration / playback * FRAME_RATE)) > MOST_PICTURES:
        what, remedy = f"a film of {moving} pictures", "set playback higher"
        where = f"playback = {playback:g} of the run"
        raise UsageError(what, where, remedy)
    moments = time[first] + np.arange(moving) * playback / FRAME_RATE
    tail = np.full(round(TAIL * FRAME_RATE), last)
    return Clock(playback, np.concatenate([np.searchsorted(time, moments), tail]))


def rows_of(time: Array, stretch: Stretch) -> tuple[int, int]:
    """First and last row within a stretch of time; equal where it holds no time."""
    start, stop = stretch
    first = min(int(np.searchsorted(time, start)), len(time) - 1)
    return first, max(int(np.searchsorted(time, stop, side="right")) - 1, first)


def _round_speeds() -> Iterator[float]:
    """1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, ... 60, 80, 100, ..."""
    yield from (1, 2, 3, 4, 5, 6, 8)
    for power in count(1):
        for digits in (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8):
            yield digits * 10.0**power


@dataclass
class Playback:
    """The moment that is shown; it passes with the wall clock unless paused."""

    end: float  # of the walk [s]
    time: float = 0.0  # that is shown [s]
    speed: float = 1.0  # against real time
    paused: bool = False

    def pass_by(self, seconds: float) -> None:
        """Let wall time pass; the walk stays at its end."""
        if not self.paused:
            self.go_to(self.time + self.speed * seconds)

    def go_to(self, time: float) -> None:
        """Show another moment [s], within the walk."""
        self.time = float(np.clip(time, 0.0, self.end))
