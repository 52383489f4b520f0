"""Floor, load and servos of a walked robot, from where its body went.

The compliant prediction walks the run's own commands on robots that differ a little,
side by side; Gauss and Newton's method finds the one that goes where the body went.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, hypot

import numpy as np

from planner import Array
from sim.compliant.phases import Course, Phases
from sim.compliant.places import Robots
from sim.fitting.estimate import Estimates, Parameter, estimate
from sim.fitting.fitting import FITTED, Told
from sim.runs.run import Run
from sim.studies.sensitivities import course_of_run

BODY = (
    Parameter(name="friction", unit="", spread=0.4, step=0.04, low=0.05),
    Parameter(name="payload", unit="kg", spread=0.3, step=0.02, low=0.0),
    Parameter(name="its place ahead", unit="kg m", spread=0.01, step=5e-4),
    Parameter(name="its place to the left", unit="kg m", spread=0.01, step=5e-4),
    Parameter(name="slope ahead", unit="rad", spread=0.03, step=2e-3),
    Parameter(name="slope to the left", unit="rad", spread=0.03, step=2e-3),
    Parameter(name="stiffness", unit="N m/rad", spread=0.5, step=0.05, logarithm=True),
)
LEVEL = 1e-5  # [rad]; a slope from which on directions of phases matter
STEPS = 4  # of the search, each of which walks eleven robots
MOMENTS = 400  # of a walk at most, at which its pose is fitted


@dataclass(frozen=True, eq=False)
class PoseFit:
    """What moved a body, and how well its last quarter is predicted."""

    found: Estimates  # one problem
    before: float  # root mean square, yaw at the mean distance of the feet [m]
    after: float  # [m]
    mass: float  # of the robot without payload [kg]
    stiffness: float  # of its servos on average [N m/rad]

    @property
    def settings(self) -> Told:
        """Settings that were seen, with their standard errors."""
        value, error = self.found.value[0], self.found.error[0]
        seen = dict(zip((p.name for p in BODY), self.found.seen[0], strict=True))
        told: dict[str, tuple[float | list[float], float | list[float]]] = {}
        if seen["friction"]:
            told["friction"] = float(value[0]), float(error[0])
        if seen["its place ahead"] and seen["its place to the left"]:
            mass = float(value[1]) if seen["payload"] and value[1] else CARRIER * self.mass
            off = float(error[1]) if seen["payload"] else 0.0
            places, errors = (value[2:4] / mass).tolist(), (error[2:4] / mass).tolist()
            told["payload"] = [mass, *places, 0.0], [off, *errors, 0.0]
        if seen["slope ahead"] and seen["slope to the left"]:
            x, y = value[4:6].tolist()
            steep, sideways = hypot(x, y), float(np.hypot(*error[4:6]))
            told["slope"] = [steep, atan2(y, x)], [sideways, sideways / max(steep, LEVEL)]
        if seen["stiffness"]:
            factor, share = np.exp(value[6]), error[6]
            told["servo_stiffness"] = (
                float(self.stiffness * factor), float(self.stiffness * factor * share)
            )
        return told


CARRIER = 0.05  # of the robot's mass; a payload whose place shows and whose mass does not


def fit_poses(run: Run) -> PoseFit:
    """Fit what moves the body of a walk to its poses.

    Raises MeasurementError where the prediction tips over.
    """
    phases, course = course_of_run(
        replace(run, settings={**run.settings, "known": "none"})
    )
    rows = np.arange(run.walking.start, len(run.time))
    rows = rows[:: max(len(rows) // MOMENTS, 1)]
    times, arm = run.time[rows], run.reach
    measured = _scaled(run.achieved[rows], arm)
    cut = 3 * int(FITTED * len(rows))
    robot = phases.robots

    def model(values: Array) -> Array:
        lanes = _changed(robot, values.reshape(-1, len(BODY)))
        walks = Phases(phases.mechanics, lanes, phases.pace).follow_all(course)
        found = [_scaled(walk.at(times).pose, arm) for walk in walks]
        return np.stack(found).reshape(*values.shape[:2], -1).swapaxes(1, 2)

    start = np.array([[robot.friction.mean(), *np.zeros(len(BODY) - 1)]])
    found = estimate(
        lambda v: model(v)[:, :cut], measured[:cut, None], BODY, start, start, STEPS
    )
    off = measured[cut:] - model(np.stack([start, found.value]))[:, cut:, 0]
    before, after = np.sqrt((off**2).mean(axis=1) * 3).tolist()
    stiffness = float(robot.stiffness.mean())
    return PoseFit(found, before, after, float(robot.mass[0]), stiffness)


def _scaled(pose: Array, arm: float) -> Array:
    """Poses (T, 3) as lengths, one after the other, (3 T,) [m]."""
    x, y, yaw = pose.T
    return np.stack([x, y, arm * np.unwrap(yaw)], axis=1).ravel()


def _changed(robot: Robots, values: Array) -> Robots:
    """Robots as lanes, for values (B, K) of `BODY`."""
    lanes = robot.take(np.zeros(len(values), dtype=int))
    friction, mass, ahead, left, down_ahead, down_left, stiffness = values.T
    body = lanes.body_mass + mass
    moment = lanes.body_mass[:, None] * lanes.body_center
    moment[:, 0] += ahead
    moment[:, 1] += left
    size = np.linalg.norm(robot.gravity[0])
    tilt = np.column_stack([down_ahead, down_left]) + LEVEL
    down = -np.sqrt(1 - (tilt**2).sum(axis=1))
    return replace(
        lanes,
        friction=lanes.friction - lanes.friction.mean() + friction[:, None, None],
        body_mass=body,
        mass=lanes.mass + mass,
        body_center=moment / body[:, None],
        gravity=size * np.column_stack([tilt, down]),
        stiffness=lanes.stiffness * np.exp(stiffness)[:, None, None],
    )
