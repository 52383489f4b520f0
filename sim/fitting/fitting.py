"""Servos fitted to logs of a robot: one make for all joints, checked on what was kept.

The first three quarters of every log are fitted, and the last quarter is predicted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from planner import Array
from sim.fitting.estimate import Estimates, together
from sim.fitting.joints import fit_servos, one_make, servos
from sim.fitting.loads import known_servos, on_floor, on_stand
from sim.fitting.servo_law import Commanded
from sim.logs.log import Log
from sim.preparation.setup import Setup
from sim.preparation.shared import built

NARROWEST = 1e-5  # [rad]; a band that all joints have, so that all are built alike
FITTED = 0.75  # of the rows of a log; the rest checks
ROUNDS = 3  # of walking on the floor, all but the first with servos as found
SHARED = {"stiffness": "servo_stiffness", "damping": "servo_damping",
          "backlash": "backlash", "delay": "command_delay"}  # fmt: skip
OWN = {"dead band": "dead_band", "zero": "zero_offset"}
Value = float | list[float]
Told = Mapping[str, tuple[Value, Value]]
"""Settings of scenarios by name, and their standard errors."""


@dataclass(frozen=True, eq=False)
class JointFit:
    """Servos of joints, alone and as one make, and how well they predict."""

    joints: tuple[str, ...]
    each: Estimates  # every joint for itself
    make: Estimates  # what they share
    own: Estimates  # what each has of its own, given what they share
    before: Array  # root mean square of what was kept: as described, (J,) [rad]
    after: Array  # and as fitted, (J,) [rad]

    def settings(self, joints: Sequence[str]) -> dict[str, tuple[Value, Value]]:
        """Settings that were seen and their standard errors, for a robot's joints."""
        found: dict[str, tuple[Value, Value]] = {}
        for k, parameter in enumerate(self.make.parameters):
            if self.make.seen[0, k]:
                told = parameter.told(self.make.value[0, k], self.make.error[0, k])
                found[SHARED[parameter.name]] = float(told[0]), float(told[1])
        place = [self.joints.index(j) if j in self.joints else None for j in joints]
        for k, parameter in enumerate(self.own.parameters):
            seen = self.own.seen[:, k]
            numbers = np.where(seen, [self.own.value[:, k], self.own.error[:, k]], 0.0)
            if seen.any():
                columns = [
                    [0.0 if i is None else float(n[i]) for i in place] for n in numbers
                ]
                found[OWN[parameter.name]] = columns[0], columns[1]
        return found


def fit_joints(setup: Setup, logs: Sequence[Log], walking: bool) -> JointFit:
    """Fit the servos of a robot to logs of the same joints, with measured angles.

    Raises SimulationError where the robot cannot walk what the log says.
    """
    start = servos(*known_servos(setup, logs[0]))
    model, whole = setup.as_planned.model, start
    for _ in range(ROUNDS if walking else 1):
        loaded = [
            on_floor(setup, model, log, whole) if walking else on_stand(setup, log)
            for log in logs
        ]
        pairs = zip(loaded, logs, strict=True)
        each = together([fit_servos(c, *_rows(log, False), start) for c, log in pairs])
        make, own, whole = one_make(each)
        if walking:
            model = _fitted_model(setup, logs[0], whole)
    before, after = (
        np.sqrt(
            np.mean(
                [_missed(c, log, s) for c, log in zip(loaded, logs, strict=True)],
                axis=0,
            )
        )
        for s in (start, whole)
    )
    return JointFit(logs[0].joints, each, make, own, before, after)


def _fitted_model(setup: Setup, log: Log, whole: Array) -> mujoco.MjModel:
    """The world of a robot whose servos are like those that were found, (J, 6)."""
    own = dict(zip(log.joints, whole[:, 2].tolist(), strict=True))
    stiffness, damping = np.exp(whole[0, :2]).tolist()
    found = replace(
        setup.scenario.as_planned,
        servo_stiffness=stiffness,
        servo_damping=damping,
        backlash=float(whole[0, 3]),
        dead_band=tuple(
            max(own.get(joint, 0.0), NARROWEST) for joint in setup.robot.card.joints
        ),
    )
    return built(setup.robot, found)[1]


def _rows(log: Log, kept: bool) -> tuple[Array, Array]:
    """Times and measured angles of the rows that are fitted, or of those kept."""
    measured = log.measured
    if measured is None:
        raise ValueError("no measured angles; give columns measured.JOINT")
    cut = int(FITTED * len(log.time))
    rows = slice(cut, None) if kept else slice(cut)
    return log.time[rows], measured[rows]


def _missed(commanded: Commanded, log: Log, tried: Array) -> Array:
    """Mean square of what the kept rows were not predicted by, (J,) [rad^2]."""
    times, measured = _rows(log, True)
    off = measured - commanded.answers(tried[None], times)[0]
    mean: Array = np.nanmean(off**2, axis=0)
    return mean
