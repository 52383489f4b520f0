"""Sensors that tell a robot's pose when it stops, and their readings in a simulation.

A camera gives the whole pose with white noise, a gyroscope the yaw alone; its error
grows as a random walk and by a constant rate. What is not measured is NaN.
"""

from dataclasses import dataclass, fields, replace
from math import inf, isfinite, radians, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from planner import Array

if TYPE_CHECKING:
    from sim.scenarios.settings import Settings

WILD = (0.1, 0.1, 0.5)  # how far a wild reading is off at most [m], [m], [rad]


@dataclass(frozen=True, kw_only=True)
class Sensing:
    """What is measured of the pose at the stop after each segment.

    Example:
        >>> from sim import Sensing
        >>> Sensing(position=0.002, yaw=0.02, readings=4).noise
        array([0.001, 0.001, 0.01 ])
    """

    position: float = 0.0  # deviation of one reading of x and y [m]; inf without one
    yaw: float = 0.0  # that of its yaw [rad]; infinite if it has none
    readings: int = 1  # taken and averaged at a stop
    every: int = 1  # stops from one that is measured to the next
    until: int | None = None  # segments after which there are no more readings
    lost: float = 0.0  # share of stops whose reading is lost
    wild: float = 0.0  # share of stops whose reading is anywhere within `WILD`
    gyro_noise: float | None = None  # growth of its error [rad/sqrt(s)], if it has one
    gyro_drift: float = 0.0  # standard deviation of its constant rate [rad/s]
    delay: float = 0.0  # time that one reading takes [s]

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is not None and not value >= 0:  # nor no number
                raise ValueError(f"{name} is {value}; give 0 or more")
            if name in ("lost", "wild") and value > 1:
                raise ValueError(f"{name} is {value}; give a share from 0 to 1")
            if name in ("readings", "every") and (value < 1 or value % 1):
                raise ValueError(f"{name} is {value}; give a whole number from 1")

    @property
    def is_exact(self) -> bool:
        """Whether every reading is the pose itself."""
        return self.position == self.yaw == self.wild == 0.0

    @property
    def sees_position(self) -> bool:
        """Whether any reading tells where the robot is."""
        return isfinite(self.position)

    @property
    def noise(self) -> Array:
        """Standard deviation of an averaged reading, x, y [m] and yaw [rad], (3,)."""
        return np.array([self.position, self.position, self.yaw]) / sqrt(self.readings)

    @property
    def stop(self) -> float:
        """Time for which the robot stands still to be seen [s]."""
        return self.readings * self.delay


KINDS = {
    "exact": Sensing(),
    "mocap": Sensing(position=0.2e-3, yaw=radians(0.1), delay=0.01),
    "tag": Sensing(position=2e-3, yaw=radians(1.0), delay=0.033),
    "gyro": Sensing(position=inf, yaw=inf, gyro_noise=2e-4, gyro_drift=2e-4),
}  # kinds of sensors by the name that the setting `sense` gives


def sensing_of(settings: "Settings") -> Sensing:
    """The sensors that a scenario asks for: a kind, and what replaces its numbers."""
    given: dict[str, Any] = {}
    for name in (field.name for field in fields(Sensing)):
        key = name if name.startswith("gyro_") else f"sense_{name}"
        if (value := getattr(settings, key)) is not None:
            given[name] = value
    return replace(KINDS[settings.sense], **given)


class Sensor:
    """Simulated readings of many walks at once, shape `batch`; drawn from `random`."""

    def __init__(
        self, sensing: Sensing, random: np.random.Generator, batch: tuple[int, ...] = ()
    ) -> None:
        self.sensing, self._random, self._batch = sensing, random, batch
        self._rate = random.normal(0.0, 1.0, batch) * sensing.gyro_drift
        self._offset = np.zeros(batch)
        self._stops = 0

    def read(self, pose: Array, seconds: float) -> Array:
        """A reading of a pose (..., 3) after a segment that took some seconds.

        It is x, y, yaw of the camera and the yaw of the gyroscope, shape (..., 4).
        """
        sensing, random = self.sensing, self._random
        self._stops += 1
        readings = np.full((*self._batch, 4), np.nan)
        noise = np.where(np.isfinite(sensing.noise), sensing.noise, np.nan)
        seen = pose + noise * random.normal(0.0, 1.0, (*self._batch, 3))
        wild = pose + np.array(WILD) * random.uniform(-1.0, 1.0, (*self._batch, 3))
        strays = random.random(self._batch) < sensing.wild
        lost = random.random(self._batch) < sensing.lost
        within = sensing.until is None or self._stops <= sensing.until
        if self._stops % sensing.every == 0 and within:
            seen = np.where(strays[..., None], wild, seen)
            readings[..., :3] = np.where(lost[..., None], np.nan, seen)
        if sensing.gyro_noise is not None:
            grown = sensing.gyro_noise * sqrt(seconds) * random.normal(size=self._batch)
            self._offset = self._offset + self._rate * seconds + grown
            readings[..., 3] = pose[..., 2] + self._offset
        return readings
