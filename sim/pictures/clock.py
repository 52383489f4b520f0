"""The clocks of film and viewer: the moment that is shown, and the playback speed."""

from dataclasses import dataclass
from math import inf

import numpy as np

from planner import Array
from sim.errors import UsageError

FRAME_RATE = 25  # [1/s]
FILM_LENGTH = 40.0  # [s] of the walk at most, where no playback speed is set
ROUNDED = np.outer(10.0 ** np.arange(1, 9), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8))
SPEEDS = (1, 2, 3, 4, 5, 6, 8, *ROUNDED.ravel().tolist())
TITLE, TAIL, RESULTS = 2.0, 1.5, 3.0  # [s] of title, last picture, card of results

Stretch = tuple[float, float]
WHOLE: Stretch = (-inf, inf)


@dataclass(frozen=True)
class Clock:
    """The pictures of a film in order."""

    playback: float  # speed against real time
    rows: Array  # of the trajectory, that each picture shows, (pictures,)
    title: int = 0  # number of pictures at the beginning that are the title card
    results: int = 0  # number of pictures at the end that are the card of results

    @property
    def scene(self) -> range:
        """The pictures of the walk, which have no card."""
        return range(self.title, len(self.rows) - self.results)

    def frame_of(self, rows: Array) -> Array:
        """First picture that shows each row or a later one, shape as given."""
        return np.searchsorted(self.rows, rows)


def clock(
    time: Array, playback: float | None = None, stretch: Stretch = WHOLE
) -> Clock:
    """Spread the pictures evenly over a walk, between two cards if it is all of it.

    Without a playback speed, take the lowest round one, real time at best, that keeps
    the film within `FILM_LENGTH`.
    """
    first, last = rows_of(time, stretch)
    duration = float(time[last] - time[first])
    if playback is None:
        playback = next(p for p in SPEEDS if duration / p <= FILM_LENGTH - TAIL)
    if (moving := int(duration / playback * FRAME_RATE)) > 100_000:  # an hour
        where = f"playback = {playback:g} of the run"
        raise UsageError(f"a film of {moving} pictures", where, "set playback higher")
    moments = time[first] + np.arange(moving) * playback / FRAME_RATE
    whole = first == 0 and last == len(time) - 1
    parts = (whole * TITLE, TAIL, whole * RESULTS)
    title, tail, results = (round(seconds * FRAME_RATE) for seconds in parts)
    begin, end = np.full(title, first), np.full(tail + results, last)
    rows = np.concatenate([begin, np.searchsorted(time, moments), end])
    return Clock(playback, rows, title, results)


def rows_of(time: Array, stretch: Stretch) -> tuple[int, int]:
    """First and last row within a stretch of time; equal where it holds no time."""
    start, stop = stretch
    first = min(int(np.searchsorted(time, start)), len(time) - 1)
    return first, max(int(np.searchsorted(time, stop, side="right")) - 1, first)


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
