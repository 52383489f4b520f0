"""Floor, load and servos of a walked robot, from where its body went.

The compliant prediction walks the run's own commands on robots that differ a little,
side by side; Gauss and Newton's method finds the one that goes where the body went.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, hypot

import numpy as np

from models.description import actuator_of
from planner import Array
from sim.compliant.anatomy import Robots
from sim.compliant.phases import Course, Phases
from sim.compliant.prediction import course_along, phases_of
from sim.fitting.estimate import Estimates, Parameter, estimate
from sim.fitting.fitting import FITTED, Told, Value
from sim.fitting.servo_law import turned
from sim.logs.log import Log
from sim.motion.poses import relative
from sim.preparation.setup import Setup
from sim.runs.run import Run
from sim.studies.sensitivities import course_of_run
from sim.world.imperfections import BACKLASH

BODY = (
    Parameter(name="friction", unit="", spread=0.4, step=0.04, low=0.05),
    Parameter(name="payload", unit="kg", spread=0.3, step=0.02, low=0.0),
    Parameter(name="its place ahead", unit="kg m", spread=0.01, step=5e-4),
    Parameter(name="its place to the left", unit="kg m", spread=0.01, step=5e-4),
    Parameter(name="slope ahead", unit="rad", spread=0.03, step=2e-3),
    Parameter(name="slope to the left", unit="rad", spread=0.03, step=2e-3),
    Parameter(name="stiffness", unit="N m/rad", spread=0.5, step=0.05, logarithm=True),
)
FRICTION, PLACE, SLOPE, STIFFNESS = [0], [2, 3], [4, 5], [6]  # told together or not
LEVEL = 1e-5  # [rad]; a slope from which on directions of phases matter
ROUNDS = 4  # of the search, each of which walks eleven robots
CARRIER = 0.05  # of the robot's mass; a payload whose place shows, and not its mass
FIRST = 0.2  # [s] whose mean pose is where a walk begins, measured and predicted
MOMENTS = 400  # of a walk at most, at which its pose is fitted


@dataclass(frozen=True, eq=False)
class PoseFit:
    """What moved a body, and how well its last quarter is predicted."""

    found: Estimates  # one problem
    held: Estimates  # of what is told, the others held as the robot was described
    before: float  # root mean square, yaw at the mean distance of the feet [m]
    after: float  # [m]
    mass: float  # of the robot without payload [kg]

    @property
    def settings(self) -> Told:
        """Settings that were seen, with their standard errors."""
        value, error = self.held.value[0], self.held.error[0]
        seen, told = self.found.seen[0], dict[str, tuple[Value, Value]]()
        if seen[FRICTION].all():
            told["friction"] = self.held.told(0)
        if seen[PLACE].all():
            mass, off = self.held.told(1) if seen[1] else (0.0, 0.0)
            mass = mass or CARRIER * self.mass
            places, errors = (value[PLACE] / mass).tolist(), error[PLACE] / mass
            told["payload"] = [mass, *places, 0.0], [off, *errors.tolist(), 0.0]
        if seen[SLOPE].all():
            x, y = value[SLOPE].tolist()
            steep, sideways = hypot(x, y), float(np.hypot(*error[SLOPE]))
            errors = [sideways, sideways / max(steep, LEVEL)]
            told["slope"] = [steep, atan2(y, x)], errors
        if seen[STIFFNESS].all():
            told["servo_stiffness"] = self.held.told(6)
        return told


@dataclass(frozen=True, eq=False)
class Walked:
    """Commands of a walk for the compliant prediction, and where the body went."""

    phases: Phases
    course: Course
    times: Array  # (T,) [s]
    pose: Array  # measured, in a frame of its own, (T, 3)
    arm: float  # mean distance of the feet from the body's centre [m]


def log_of(run: Run) -> Log:
    """A walk as the log of a robot that was told what it was, seen without noise."""
    rows, joints = run.walking, run.card.joints
    return Log(
        time=run.time[rows] - run.time[rows][0],
        joints=joints,
        commanded=run.ctrl[rows][:, [actuator_of(run.model, j) for j in joints]],
        measured=turned(run.model, run.qpos[rows], joints, BACKLASH),
        pose=run.achieved[rows],
    )


def walked_of_run(run: Run) -> Walked:
    """A finished run; the prediction is told none of its imperfections."""
    untold = replace(run, settings={**run.settings, "known": "none"})
    phases, course = course_of_run(untold)
    rows = run.walking
    return Walked(phases, course, run.time[rows], run.achieved[rows], run.reach)


def walked_of_log(setup: Setup, log: Log) -> Walked:
    """A log with the body's pose; the robot first stands as in its first row.

    Raises ValueError where a pose is missing.
    """
    motion, dt = setup.motion, setup.limits.timestep
    if motion is None or log.pose is None or not np.isfinite(log.pose).all():
        columns = "body.x, body.y, body.yaw"
        raise ValueError(f"poses are missing; give {columns} in every row")
    hold = round(setup.limits.hold / dt)
    walked = motion.schedule(hold, hold + motion.steps)
    parts = [motion.schedule(0, hold, standing=True), walked]
    ctrl = np.concatenate([rows for part in parts for rows in setup.commands(part)])
    spans = np.array([(p.start, p.stop) for part in parts for p in part.phases])
    phases, none = phases_of(setup.as_planned), np.zeros(len(spans))
    course = course_along(setup, phases, ctrl, spans, none, {0: np.zeros(3)})
    times = hold * dt + log.time
    return Walked(phases, course, times, log.pose, setup.kinematics.reach)


def fit_poses(walked: Walked) -> PoseFit:
    """Fit what moves the body of a walk to its poses.

    Raises MeasurementError where the prediction tips over.
    """
    phases, robot = walked.phases, walked.phases.robots
    rows = slice(None, None, max(len(walked.times) // MOMENTS, 1))
    times = walked.times[rows]
    first = times - times[0] < FIRST
    measured = _scaled(walked.pose[rows], first, walked.arm)
    cut = 3 * int(FITTED * len(times))

    def model(values: Array) -> Array:
        lanes = _changed(robot, values.reshape(-1, len(BODY)))
        walks = Phases(phases.mechanics, lanes).follow_all(walked.course)
        found = [_scaled(walk.at(times).pose, first, walked.arm) for walk in walks]
        return np.stack(found).reshape(*values.shape[:2], -1).swapaxes(1, 2)

    friction, stiffness = robot.friction.mean(), np.log(robot.stiffness).mean()
    start = np.array([[friction, *np.zeros(len(BODY) - 2), stiffness]])
    found = estimate(
        lambda v: model(v)[:, :cut], measured[:cut, None], BODY, start, start, ROUNDS
    )
    seen = found.seen[0]
    hidden = [g for g in (FRICTION, PLACE, SLOPE, STIFFNESS) if not seen[g].all()]
    without = {k for group in hidden for k in group}
    if PLACE in hidden or not seen[1]:
        without.add(1)
    held = found.held(without)
    off = measured[cut:] - model(np.stack([start, held.value]))[:, cut:, 0]
    before, after = np.sqrt((off**2).mean(axis=1) * 3).tolist()
    return PoseFit(found, held, before, after, float(robot.mass[0]))


def _scaled(pose: Array, first: Array, arm: float) -> Array:
    """Poses (T, 3) from the mean of the first ones, one after the other, (3 T,) [m]."""
    pose = np.column_stack([pose[:, :2], np.unwrap(pose[:, 2])])
    x, y, yaw = relative(pose[first].mean(axis=0), pose).T
    return np.stack([x, y, arm * np.unwrap(yaw)], axis=1).ravel()


def _changed(robot: Robots, values: Array) -> Robots:
    """Robots as lanes, for values (B, K) of `BODY`."""
    lanes = robot.take(np.zeros(len(values), dtype=int))
    friction, mass, ahead, left, down_ahead, down_left, stiffness = values.T
    body = lanes.body_mass + mass
    moment = lanes.body_mass[:, None] * lanes.body_center
    moment[:, 0] += ahead
    moment[:, 1] += left
    size, usual = np.linalg.norm(robot.gravity[0]), np.log(robot.stiffness).mean()
    tilt = np.column_stack([down_ahead, down_left]) + LEVEL
    down = -np.sqrt(1 - (tilt**2).sum(axis=1))
    return replace(
        lanes,
        friction=lanes.friction - lanes.friction.mean() + friction[:, None, None],
        body_mass=body,
        mass=lanes.mass + mass,
        body_center=moment / body[:, None],
        gravity=size * np.column_stack([tilt, down]),
        stiffness=lanes.stiffness * np.exp(stiffness - usual)[:, None, None],
    )
