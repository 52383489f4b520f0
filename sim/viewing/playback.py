"""The playback of a finished walk: which moment is shown, and how time passes."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from planner import Array, open_file
from sim.errors import UsageError
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
    try:
        with (
            open_file(folder / "trajectory.npz") as one,
            open_file(folder / "commands.npz") as other,
            np.load(one, allow_pickle=False) as states,
            np.load(other, allow_pickle=False) as commands,
        ):
            rows = np.searchsorted(commands["time"], states["time"] - 1e-9)
            last = len(commands["time"]) - 1
            ctrl = commands["ctrl"][np.minimum(rows, last)]
            return RecordedWalk(shown, states["qvel"], ctrl)
    except (OSError, KeyError, ValueError, IndexError, zipfile.BadZipFile) as error:
        raise UsageError(
            f"not to be played, {error}", str(folder), "give a finished run's folder"
        ) from error


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
