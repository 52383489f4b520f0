"""Measurement of the feet from sensors: contact, contact points and slip.

A foot is in contact while the summed normal force of its geoms exceeds one per cent of
the weight; shorter interruptions than `BOUNCE` do not end a contact, they are counted.
Slip is the tangential speed of the foot's material at the contact point, integrated
over the time in contact.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import mujoco
import numpy as np

from models import Robot
from planner import Array
from sim.world.sensors import CONTACT_FIELDS, contact_sensor

LOADED = 0.01  # of the weight
BOUNCE = 0.02  # [s]
# Of the fields of a contact: found 1, force 3, position 3, relative velocity 3.
NORMAL, PLACE, SLIDING = 1, (4, 5), (8, 9)


@dataclass(frozen=True, slots=True)
class Readings:
    """Feet and centre of mass over consecutive steps, in world coordinates."""

    force: Array  # normal force, (n, F) [N]
    speed: Array  # tangential speed at the contact, (n, F) [m/s]
    point: Array  # centre of pressure of the foot, (n, F, 2) [m]; 0 where none
    center_of_mass: Array  # (n, 3) [m]


class Sensors:
    """Reads the contact sensors of a robot's feet out of sensordata."""

    def __init__(self, model: mujoco.MjModel, robot: Robot) -> None:
        self.weight = robot.weight_in(model)
        self.feet = len(robot.legs)
        self._slots = _slots(model, robot)
        self._center_of_mass = model.sensor("center_of_mass").adr[0]

    def read(self, sensordata: Array) -> Readings:
        """Readings of every step, from sensordata of shape (n, nsensordata)."""
        normals = [
            np.maximum(sensordata[:, at + NORMAL], 0.0) * real
            for at, real in self._slots
        ]
        force: Array = sum(normals, np.zeros(1))
        whole = np.where(force > 0, force, 1.0)
        speed, point = np.zeros(force.shape), np.zeros((*force.shape, 2))
        for (at, _), normal in zip(self._slots, normals, strict=True):
            share = normal / whole
            speed += share * np.hypot(*(sensordata[:, at + k] for k in SLIDING))
            for axis, place in enumerate(PLACE):
                point[..., axis] += share * sensordata[:, at + place]
        at = self._center_of_mass
        return Readings(force, speed, point, sensordata[:, at : at + 3].copy())

    def loaded(self, readings: Readings) -> Array:
        """Whether each foot carries more than `LOADED` of the weight, (n, F), bool."""
        return readings.force > LOADED * self.weight


def _slots(model: mujoco.MjModel, robot: Robot) -> list[tuple[Array, Array]]:
    """Address in sensordata of each foot's k-th contact, and whether it has as many."""
    feet = []
    for leg in robot.leg_cards:
        sensors = (model.sensor(contact_sensor(geom)) for geom in leg.foot)
        ranges = [(s.adr[0], s.adr[0] + s.dim[0]) for s in sensors]
        feet.append([at for ends in ranges for at in range(*ends, CONTACT_FIELDS)])
    most = max(map(len, feet))
    addresses = np.array([at + at[:1] * (most - len(at)) for at in feet]).T
    real = np.array([[k < len(at) for at in feet] for k in range(most)])
    return list(zip(addresses, real, strict=True))


class ContactLog(NamedTuple):
    """Which feet were in contact, as a list of changes."""

    step: Array  # from the state after these many steps on, ascending, (n,)
    flags: Array  # these feet, (n, F), bool

    def between(self, first: int, last: int) -> Array:
        """Flags of the states after `first` to `last` steps, each change one row."""
        begin = self.step.searchsorted(first, side="right") - 1
        return self.flags[begin : self.step.searchsorted(last, side="right")]


def last_touched(point: Array, touching: Array, before: Array | None = None) -> Array:
    """Contact points (n, F, 2); where a foot does not touch, the last that it touched.

    Those touched before the first step have shape (1, F, 2).
    """
    first = point[:1] if before is None else before
    steps = np.where(touching, np.arange(1, len(point) + 1)[:, None], 0)
    last = np.maximum.accumulate(steps, axis=0)  # (n, F), 0 for `first`
    return np.take_along_axis(np.concatenate([first, point]), last[:, :, None], axis=0)


def bridge(loaded: Array, shortest: int, before: Array | None = None) -> Array:
    """Contact: load, with interruptions shorter than `shortest` steps closed.

    Flags have shape (n, F); contact before the first of them, shape (1, F), is none if
    not given.
    """
    known = _after(before, loaded)
    contact = known.copy()
    for foot in range(known.shape[1]):
        edges = np.flatnonzero(np.diff(known[:, foot].astype(np.int8)))
        for fall, rise in pairwise(edges):
            if known[fall, foot] and rise - fall < shortest:
                contact[fall + 1 : rise + 1, foot] = True
    return contact[1:]


def count_bounces(loaded: Array, contact: Array) -> Array:
    """Each foot's interruptions closed, (F,), that end before the last of steps."""
    closed = contact & ~loaded
    return (closed[:-1] & ~closed[1:]).sum(axis=0)


def decided(loaded: Array, shortest: int, before: Array | None = None) -> int:
    """Number of leading steps whose contacts no later step can change.

    Arguments are those of `bridge`. An interruption that is still open at the end and
    shorter than `shortest` may turn out to be a bounce.
    """
    known = _after(before, loaded)
    last = np.where(known, np.arange(len(known))[:, None], -shortest).max(axis=0)
    count = len(loaded)
    return int(last[count - last < shortest].min(initial=count))


def _after(before: Array | None, loaded: Array) -> Array:
    """Flags with one more row in front, for the time before."""
    none = np.zeros((1, loaded.shape[1]), dtype=bool)
    return np.concatenate([none if before is None else before, loaded])
