"""Recordings: commands are played on the engine, and what evaluation needs is kept.

The engine computes the sensors of a state in the step that leaves it, so the readings
of the state after n steps come with step n + 1, and those of the last state are
computed separately. A contact is final once no later step can turn an interruption of
it into a bounce.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import mujoco
import numpy as np

from models import Robot
from planner import Array
from sim.motion.stability import LeastMargin, carrying
from sim.physics.engine import Engine, State
from sim.physics.measure import (
    BOUNCE,
    ContactLog,
    Sensors,
    bridge,
    count_bounces,
    decided,
    last_touched,
)
from sim.world.sensors import SELF_CONTACT, Touches

NEVER = np.iinfo(np.int64).max
NONE = np.zeros(0, dtype=int)
NEAR_END = 1e-6  # of a range of forces, within which its end counts as reached
T = TypeVar("T", bound=Iterable[Array])


class Sensed(NamedTuple):
    """Consecutive states as the sensors read them, in world coordinates, (T, ...)."""

    step: Array  # (T,)
    qpos: Array  # (T, nq)
    qvel: Array  # (T, nv)
    point: Array  # where each foot touches the ground, or last did, (T, F, 2) [m]
    center_of_mass: Array  # (T, 3) [m]
    loaded: Array  # whether each foot bears load, (T, F), bool
    speed: Array  # at the contact, (T, F) [m/s]


class Moments(NamedTuple):
    """States at recorded moments, their contacts decided, in world coordinates."""

    step: Array  # (T,)
    qpos: Array  # (T, nq)
    qvel: Array  # (T, nv)
    point: Array  # where each foot touches the ground, or last did, (T, F, 2) [m]
    center_of_mass: Array  # (T, 3) [m]
    contact: Array  # load, with bounces bridged, (T, F), bool
    slip: Array  # so far, (T, F) [m]

    def at(self, which: slice | Array) -> "Moments":
        """Some of them."""
        return Moments(*(column[which] for column in self))


class Marks(NamedTuple):
    """Reasons why moments are recorded, shape (T,) each, bool."""

    sampled: Array  # as every n-th
    inspected: Array  # as requested


@dataclass(frozen=True)
class Recording:
    """A finished simulation."""

    timestep: float  # [s]
    steps: int
    moments: Moments
    marks: Marks
    contacts: ContactLog
    bounces_of: Array  # each foot's, (F,)
    limited: Array  # steps in which each actuator gave all the force it has, (nu,)
    least_margin: float  # over every step from the walk's start on [m]
    wall_contacts: int  # times that it came to touch an obstacle, or what else stands
    self_contacts: int  # times that it came to touch itself

    @property
    def bounces(self) -> int:
        """Those of all feet."""
        return int(self.bounces_of.sum())

    @property
    def during(self) -> Array:
        """Index of the step that leads to each moment, shape (T,)."""
        return self.moments.step - 1

    def slip_after(self, step: int) -> Array:
        """Slip of every foot up to a moment that was kept, shape (F,) [m]."""
        return self.moments.slip[self.moments.step == step][0]


class Recorder:
    """Advances an engine and gathers a `Recording`."""

    def __init__(self, engine: Engine, sensors: Sensors, sample_every: int) -> None:
        self.engine = engine
        self.walk_starts = NEVER  # step from which on margins count
        self._sensors, self._every = sensors, sample_every
        self._timestep = float(engine.model.opt.timestep)
        self._shortest = round(BOUNCE / self._timestep)
        self._touches = Touches(engine.model)
        self._own_touches = Touches(engine.model, SELF_CONTACT)
        self._margin = LeastMargin()
        self._inspections = NONE
        self._state = engine.state
        self._touched: Array | None = None
        self._pending: list[Sensed] = []
        self._kept: list[Moments] = []
        self._marks: list[Marks] = []
        self._contacts: list[ContactLog] = []
        self._contact: Array | None = None
        self._slip = np.zeros(sensors.feet)
        self._bounces = np.zeros(sensors.feet, dtype=int)
        self._limited = np.zeros(engine.model.nu, dtype=int)

    def play(self, pieces: Iterable[Array], inspections: Array = NONE) -> Iterator[int]:
        """Apply one row of commands a step, and yield the steps made after each piece.

        Pieces have at most `STRETCH` rows. The state is kept after steps to be
        inspected, in ascending order.
        """
        self._inspections = np.concatenate([self._inspections, inspections])
        for ctrl in pieces:
            before, record = self.engine.steps, self.engine.advance(ctrl)
            self._limited += self._at_limit(record.actuator_force)
            qpos = np.concatenate([self._state.qpos[None], record.qpos])
            qvel = np.concatenate([self._state.qvel[None], record.qvel])
            self._state = State(qpos[-1].copy(), qvel[-1].copy())
            self._sense(before, qpos[:-1], qvel[:-1], record.sensordata)
            self._decide()
            yield self.engine.steps

    def finish(self) -> Recording:
        """Everything recorded; the last state is always kept."""
        state, sensed = self._state, self.engine.sense()
        self._sense(self.engine.steps, state.qpos[None], state.qvel[None], sensed[None])
        self._decide(last=True)
        return Recording(
            timestep=self._timestep,
            steps=self.engine.steps,
            moments=Moments(*_joined(self._kept)),
            marks=Marks(*_joined(self._marks)),
            contacts=ContactLog(*_joined(self._contacts)),
            bounces_of=self._bounces,
            limited=self._limited,
            least_margin=self._margin.value,
            wall_contacts=self._touches.count,
            self_contacts=self._own_touches.count,
        )

    def _at_limit(self, force: Array) -> Array:
        """In how many steps, (n, nu), each actuator gave all the force that it has."""
        model = self.engine.model
        low, high = model.actuator_forcerange.T
        near = NEAR_END * (high - low)
        full = (force <= low + near) | (force >= high - near)
        return (full & (model.actuator_forcelimited > 0)).sum(axis=0)

    def _sense(self, first: int, qpos: Array, qvel: Array, sensordata: Array) -> None:
        """Add consecutive states and their sensor readings."""
        self._touches.read(sensordata)
        self._own_touches.read(sensordata)
        readings = self._sensors.read(sensordata)
        point = last_touched(readings.point, readings.force > 0, self._touched)
        self._touched = point[-1:].copy()
        steps, loaded = first + np.arange(len(qpos)), self._sensors.loaded(readings)
        seen = steps, qpos, qvel, point, readings.center_of_mass, loaded, readings.speed
        self._pending.append(Sensed(*seen))

    def _decide(self, last: bool = False) -> None:
        """Evaluate the states whose contacts no later step can change."""
        states = Sensed(*_joined(self._pending))
        loaded, before = states.loaded, self._contact
        contact = bridge(loaded, self._shortest, before)
        count = len(contact) if last else decided(loaded, self._shortest, before)
        self._bounces += count_bounces(loaded[: count + 1], contact[: count + 1])
        if count < len(contact):
            self._pending = [Sensed(*(column[count:] for column in states))]
        if count:
            *known, _, speed = (column[:count] for column in states)
            steps = np.where(contact[:count], speed, 0.0) * self._timestep
            slip = self._slip + np.cumsum(steps, axis=0)
            self._slip = slip[-1]
            ahead = contact[:count], slip - steps  # a state's own speed is yet to come
            self._keep(Moments._make([*known, *ahead]), last)

    def _keep(self, states: Moments, last: bool) -> None:
        step, contact = states.step, states.contact
        before = ~contact[:1] if self._contact is None else self._contact
        changed = np.diff(np.vstack([before, contact]), axis=0).any(axis=1)
        self._contacts.append(ContactLog(states.step[changed], contact[changed]))
        self._contact = contact[-1:].copy()
        walking = states.at(slice(int(step.searchsorted(self.walk_starts)), None))
        if len(walking.step):
            feet = carrying(walking.point, walking.contact, walking.center_of_mass)
            self._margin.see(walking.point, feet, walking.center_of_mass[:, :2])
        sampled = (step > 0) & (step % self._every == 0)
        ahead = self._inspections.searchsorted([step[0], step[-1] + 1])
        inspected = np.zeros(len(step), dtype=bool)
        inspected[self._inspections[slice(*ahead)] - step[0]] = True
        self._inspections = self._inspections[ahead[1] :]
        if last:
            sampled[-1] = inspected[-1] = True
        kept = np.flatnonzero(sampled | inspected)
        self._kept.append(states.at(kept))
        self._marks.append(Marks(sampled[kept], inspected[kept]))


def recorded(
    model: mujoco.MjModel,
    robot: Robot,
    commands: Iterable[Array],
    sample_every: int,
    inspections: Array = NONE,
    walk_starts: int = NEVER,
) -> Recording:
    """What comes of commands on a model, from its start to the end of the commands."""
    recorder = Recorder(Engine(model), Sensors(model, robot), sample_every)
    recorder.walk_starts = walk_starts
    for _ in recorder.play(commands, inspections):
        pass
    return recorder.finish()


def _joined(parts: list[T]) -> Iterator[Array]:
    """Each column of consecutive parts as one array; the parts are emptied."""
    columns = [list(column) for column in zip(*parts, strict=True)]
    parts.clear()
    for column in columns:
        yield column[0] if len(column) == 1 else np.concatenate(column)
        column.clear()
