"""The playback of a finished walk: which moment is shown, and how time passes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


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
