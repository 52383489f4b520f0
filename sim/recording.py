"""Play commands on the engine and keep what evaluation needs, and no more.

Sensors are reduced stretch by stretch to contact, slip speed and positions, so a walk
of minutes at half a millisecond a step stays within a few hundred megabytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sim.measure import FootLog, Sensors, last_touched, log_feet
from sim.obstacles.walls import Touches
from sim.physics import STRETCH, Engine

Array = np.ndarray
Samples = tuple[Array, ...]  # qpos, qvel, point, centre of mass


@dataclass(frozen=True)
class Recording:
    """A finished simulation: commands and feet at every step, states at every row."""

    timestep: float  # [s]
    ctrl: Array  # (T, nu)
    rows: Array  # steps after which a row was taken, (T',)
    qpos: Array  # (T', nq)
    qvel: Array  # (T', nv)
    point: Array  # where each foot touches the ground, or last did, (T', F, 2) [m]
    center_of_mass: Array  # (T', 3) [m]
    feet: FootLog  # (T, F)
    wall_contacts: int  # times that the robot came to touch an obstacle

    @property
    def at_rows(self) -> Array:
        """Index of the step that each row closes, shape (T',)."""
        return self.rows - 1


class Recorder:
    """Advances an engine and gathers a `Recording`."""

    def __init__(self, engine: Engine, sensors: Sensors, sample_every: int) -> None:
        self.engine = engine
        self._sensors, self._every = sensors, sample_every
        self._touches = Touches(engine.model)
        self._ctrl: list[Array] = []
        self._rows: list[Array] = []
        self._samples: list[Samples] = []
        self._feet: list[tuple[Array, Array]] = []  # loaded, speed
        self._last: Samples | None = None

    def play(self, ctrl: Array) -> Iterator[float]:
        """Apply one row of commands a step, shape (n, nu), stretch by stretch.

        Yields:
            How much of it is done, from 0 to 1.
        """
        self._ctrl.append(ctrl)
        for begin in range(0, len(ctrl), STRETCH):
            stretch = ctrl[begin : begin + STRETCH]
            self._record(stretch)
            yield (begin + len(stretch)) / len(ctrl)

    def _record(self, ctrl: Array) -> None:
        before = self.engine.steps
        record = self.engine.advance(ctrl)
        self._touches.read(record.sensordata)
        readings = self._sensors.read(record.sensordata)
        touched = None if self._last is None else self._last[2]
        point = last_touched(readings.point, readings.force > 0, touched)
        states = (record.qpos, record.qvel, point, readings.center_of_mass)
        due = np.arange(self._every - before % self._every, len(ctrl) + 1, self._every)
        self._rows.append(before + due)
        self._samples.append(tuple(s[due - 1] for s in states))
        self._last = tuple(s[-1:].copy() for s in states)
        self._feet.append((self._sensors.loaded(readings), readings.speed.astype("f4")))

    def finish(self) -> Recording:
        """Everything recorded; the last state is always a row."""
        timestep = float(self.engine.model.opt.timestep)
        rows, samples = np.concatenate(self._rows), list(self._samples)
        if self._last is not None and (not len(rows) or rows[-1] != self.engine.steps):
            rows = np.append(rows, self.engine.steps)
            samples.append(self._last)
        qpos, qvel, point, center = (
            np.concatenate(column) for column in zip(*samples, strict=True)
        )
        loaded, speed = (np.concatenate(c) for c in zip(*self._feet, strict=True))
        return Recording(
            timestep=timestep,
            ctrl=np.concatenate(self._ctrl),
            rows=rows,
            qpos=qpos,
            qvel=qvel,
            point=point,
            center_of_mass=center,
            feet=log_feet(loaded, speed, timestep),
            wall_contacts=self._touches.count,
        )
