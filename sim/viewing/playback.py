"""The playback of a finished walk: which moment is shown, and how time passes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from planner import Array
from sim.finished_run import arrays_of, reading
from sim.pictures.filmed_walk import FilmedWalk, read_walk


@dataclass(frozen=True)
class RecordedWalk:
    """A walk with what contact forces follow from.

    Attributes:
        shown: What films show of it.
        qvel: Velocities, shape (T, nv).
        ctrl: Commands in force, shape (T, nu).
    """

    shown: FilmedWalk
    qvel: Array
    ctrl: Array


def read_recorded(folder: Path) -> RecordedWalk:
    """Read a run folder.

    Args:
        folder: Of a finished run.

    Raises:
        UsageError: If it is not the folder of a finished run.
    """
    shown = read_walk(folder)
    with reading(folder, "not to be played"):
        states = arrays_of(folder, "trajectory.npz", ("time", "qvel"))
        commands = arrays_of(folder, "commands.npz")
        rows = np.searchsorted(commands["time"], states["time"] - 1e-9)
        ctrl = commands["ctrl"][np.minimum(rows, len(commands["time"]) - 1)]
        return RecordedWalk(shown, states["qvel"], ctrl)


@dataclass
class Playback:
    """The moment that is shown; it passes with the wall clock unless it is paused.

    Attributes:
        end: Last moment of the walk [s].
        time: Moment that is shown [s].
        speed: Against real time.
        paused: Whether time stands still.
    """

    end: float
    time: float = 0.0
    speed: float = 1.0
    paused: bool = False

    def pass_by(self, seconds: float) -> None:
        """Let wall time pass; the walk stays at its end.

        Args:
            seconds: Of the wall clock.
        """
        if not self.paused:
            self.go_to(self.time + self.speed * seconds)

    def go_to(self, time: float) -> None:
        """Show another moment, within the walk.

        Args:
            time: Which one [s].
        """
        self.time = float(np.clip(time, 0.0, self.end))
