"""Play commands on the engine and keep what evaluation needs, and no more.

Sensors are reduced stretch by stretch to contact, slip speed and positions, so a walk of
minutes at half a millisecond a step stays within a few hundred megabytes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim.measure import FootLog, Readings, Sensors, log_feet
from sim.physics import STRETCH, Engine

Array = np.ndarray
Progress = Callable[[int], None]  # called with the steps just done


@dataclass(frozen=True)
class Recording:
    """A finished simulation: commands and feet at every step, states at every row."""

    timestep: float  # [s]
    ctrl: Array  # (T, nu)
    rows: Array  # steps after which a row was taken, (T',)
    qpos: Array  # (T', nq)
    qvel: Array  # (T', nv)
    feet: FootLog  # (T, ...)

    @property
    def at_rows(self) -> Array:
        """Index of the step that each row closes, shape (T',)."""
        return self.rows - 1


class Recorder:
    """Advances an engine and gathers a `Recording`."""

    def __init__(
        self,
        engine: Engine,
        sensors: Sensors,
        sample_every: int,
        progress: Progress | None = None,
    ) -> None:
        self.engine = engine
        self._sensors, self._every, self._progress = sensors, sample_every, progress
        self._ctrl: list[Array] = []
        self._rows: list[Array] = []
        self._states: list[tuple[Array, Array]] = []
        self._readings: list[Readings] = []
        self._last: tuple[Array, Array] | None = None

    def play(self, ctrl: Array) -> None:
        """Apply one row of commands a step, shape (n, nu)."""
        self._ctrl.append(ctrl)
        for begin in range(0, len(ctrl), STRETCH):
            self._stretch(ctrl[begin : begin + STRETCH])

    def _stretch(self, ctrl: Array) -> None:
        before = self.engine.steps
        record = self.engine.advance(ctrl)
        due = np.arange(self._every - before % self._every, len(ctrl) + 1, self._every)
        self._rows.append(before + due)
        self._states.append((record.qpos[due - 1], record.qvel[due - 1]))
        self._last = (record.qpos[-1:], record.qvel[-1:])
        self._readings.append(self._sensors.read(record.sensordata))
        if self._progress is not None:
            self._progress(len(ctrl))

    def finish(self) -> Recording:
        """Everything recorded; the last state is always a row."""
        timestep = float(self.engine.model.opt.timestep)
        rows, states = np.concatenate(self._rows), list(self._states)
        if self._last is not None and (not len(rows) or rows[-1] != self.engine.steps):
            rows = np.append(rows, self.engine.steps)
            states.append(self._last)
        qpos, qvel = (np.concatenate(c) for c in zip(*states, strict=True))
        feet = log_feet(_joined(self._readings), self._sensors.weight, timestep)
        return Recording(timestep, np.concatenate(self._ctrl), rows, qpos, qvel, feet)


def _joined(readings: list[Readings]) -> Readings:
    names = ("force", "speed", "point", "center_of_mass")
    return Readings(*(np.concatenate([getattr(r, n) for r in readings]) for n in names))
