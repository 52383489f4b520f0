"""The engine: steps a model through given commands, in stretches of many steps.

MuJoCo raises no error when a simulation diverges; its warnings are therefore checked
after every stretch.
"""

import time
from typing import NamedTuple

import mujoco
import numpy as np
from mujoco import batch

from models.description import ON_JOINT, silence_the_engine
from planner import Array
from sim.errors import SimulationError

OF_SPEED = (mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
LAST_STATES = 100  # states before a divergence
RUNAWAY = 100.0  # [rad/s] or [m/s], which no joint is commanded to
STRETCH = 4000  # steps of one record at most: a tenth of a second of work as a rule
FIRST = 50  # steps handed to the engine at once to begin with
BUSY_TIME = 0.3  # [s] that it may be busy at once, Ctrl-C waits meanwhile


class Record(NamedTuple):
    """States and sensor readings of consecutive steps."""

    qpos: Array  # (n, nq), after each step
    qvel: Array  # (n, nv), after each step
    sensordata: Array  # (n, nsensordata), of the state before each step
    actuator_force: Array  # (n, nu), during each step


class State(NamedTuple):
    """The state of a simulation."""

    qpos: Array  # (nq,)
    qvel: Array  # (nv,)


class Engine:
    """One simulation that starts at keyframe `start`."""

    def __init__(self, model: mujoco.MjModel) -> None:
        silence_the_engine()
        self.model = model
        self._batch = batch.Batch(model, nsim=1, nthread=1)
        stage = mujoco.mjtStage.mjSTAGE_NONE.value
        self._batch.reset(keyframe=model.key("start").id, stage=stage)
        self._warnings = self._batch.warning.copy()
        self._recent: State | None = None  # what led to the state now, (n, ...) each
        self._piece = FIRST
        self.last: State | None = None  # states before a divergence, (n, ...) each
        self.steps = 0

    @property
    def state(self) -> State:
        """After the last step."""
        return State(*(np.array(self._batch.bind(name)[0]) for name in State._fields))

    @property
    def moment(self) -> tuple[Array, int]:
        """All that the next step depends on, to come back to by `rewind`."""
        return self._batch.state.copy(), self.steps

    def rewind(self, moment: tuple[Array, int]) -> None:
        """Go on from an earlier moment of this simulation."""
        self._batch.state[:], self.steps = moment

    def sense(self) -> Array:
        """Sensor readings of the state under the last command, (nsensordata,)."""
        data = self._batch.get_data(0)
        mujoco.mj_forward(self.model, data)
        return np.array(data.sensordata)

    def advance(self, ctrl: Array) -> Record:
        """Apply one row of commands a step, shape (n, nu), at most `STRETCH` rows.

        Raises SimulationError if a command is not finite, or the simulation diverges.
        """
        finite = np.isfinite(ctrl)
        if not finite.all():
            step, channel = np.argwhere(~finite)[0].tolist()
            name = self.model.actuator(channel).name
            raise self._failure(f"command of {name!r} is {ctrl[step, channel]}", step)
        parts, done = [], 0
        while done < len(ctrl):
            parts.append(self._play(ctrl[done : done + self._piece]))
            done += len(parts[-1].qpos)
        if len(parts) == 1:
            return parts[0]
        return Record(*map(np.concatenate, zip(*parts, strict=True)))

    def _play(self, ctrl: Array) -> Record:
        """Apply commands at once, and measure how many may be next time."""
        began = time.perf_counter()
        items = Record._fields
        try:
            out = self._batch.rollout(len(ctrl), control=ctrl[None], record=items)
        except batch.SimulationError as error:
            raise self._failure(str(error), 0) from error
        record = Record(*(out[item][0] for item in items))
        self._check_warnings(record)
        self._recent = self._last(record, len(ctrl))
        self.steps += len(ctrl)
        a_step = (time.perf_counter() - began) / len(ctrl)
        self._piece = min(max(int(BUSY_TIME / a_step), 1), 4 * self._piece, STRETCH)
        return record

    def _check_warnings(self, record: Record) -> None:
        now = self._batch.warning
        differ = (now != self._warnings).reshape(-1, now.shape[-1])
        risen = np.flatnonzero(differ[..., -1])
        if len(risen):
            moved = np.flatnonzero((np.diff(record.qpos, axis=0) != 0).any(axis=1))
            step = int(moved[-1]) + 1 if len(moved) else 0
            name = mujoco.mjtWarning(int(risen[0])).name.removeprefix("mjWARN_")
            self.last = self._last(record, step + 1)
            at = self._runaway(self.last.qvel)
            at = at or self._joint(int(risen[0]), int(now[0, risen[0], 0]))
            failure = self._failure(f"simulation diverged{at}, warning {name}", step)
            self.steps += step + 1  # the engine completed this step and no further one
            raise failure

    def _runaway(self, qvel: Array) -> str:
        """Which joint ran away first; not the root, which others throw, nor a fan."""
        model, joints = self.model, self.model.dof_jntid
        turns = np.isin(model.actuator_trntype, ON_JOINT)
        turned = model.actuator_trnid[turns & (model.actuator_biasprm[:, 1] == 0), 0]
        own = model.jnt_type[joints] != mujoco.mjtJoint.mjJNT_FREE
        speed = np.where(own & ~np.isin(joints, turned), np.abs(qvel), 0.0)
        rows = np.flatnonzero((speed > RUNAWAY).any(axis=1))
        if not len(rows):
            return ""
        return f" at joint {model.joint(joints[speed[rows[0]].argmax()]).name!r}"

    def _joint(self, warning: int, place: int) -> str:
        """Which joint a warning is about, in words; it tells a coordinate's place."""
        model, of_speed = self.model, warning in OF_SPEED
        if not (of_speed or warning == mujoco.mjtWarning.mjWARN_BADQPOS):
            return ""
        begin = model.jnt_dofadr if of_speed else model.jnt_qposadr
        joints = np.flatnonzero(begin <= place)
        return f" at joint {model.joint(int(joints[-1])).name!r}" if len(joints) else ""

    def _last(self, record: Record, count: int) -> State:
        """States of the last steps up to one of a record, at most `LAST_STATES`."""
        new = slice(max(count - LAST_STATES, 0), count)
        last = State(record.qpos[new], record.qvel[new])
        if self._recent is None or count >= LAST_STATES:
            return last
        pairs = zip(self._recent, last, strict=True)
        return State(*(np.concatenate(pair)[-LAST_STATES:] for pair in pairs))

    def _failure(self, what: str, step: int) -> SimulationError:
        time = (self.steps + step) * self.model.opt.timestep
        return SimulationError(
            what, f"t = {time:.4f} s", "try a smaller timestep or softer servos"
        )
