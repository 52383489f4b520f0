"""Floor, load and servos of a walked robot, from where its body went.

The compliant prediction walks the run's own commands on robots that differ a little,
side by side; Gauss and Newton's method finds the one that goes where the body went.
"""

from dataclasses import dataclass, replace
from math import atan2, hypot

import numpy as np

from models import Robot
from models.description import actuators_driving
from planner import Array
from sim.compliant.anatomy import Robots
from sim.compliant.phases import Course, Phases
from sim.compliant.prediction import course_along, phases_of
from sim.drive.drive import zero_offsets
from sim.errors import message
from sim.fitting.estimate import Estimates, estimate, parameters_of
from sim.fitting.fitting import FITTED, Fitted
from sim.logs.log import Log
from sim.motion.poses import relative
from sim.preparation.setup import Setup
from sim.runs.run import Run
from sim.studies.sensitivities import course_of_run
from sim.world.imperfections import BACKLASH, turned

BODY = parameters_of("body")
SETTINGS = {"friction": [0], "payload": [1, 2, 3], "slope": [4, 5],
            "servo_stiffness": [6]}  # shown if any of them is seen  # fmt: skip
LEVEL = 1e-5  # [rad]; a slope from which on directions of phases matter
LIGHTEST = 0.03  # [kg]; a payload whose place shows, and not its mass
MOMENTS = 400  # of a walk at most, at which its pose is fitted


@dataclass(frozen=True, eq=False)
class PoseFit:
    """What moved a body, and how well its last quarter is predicted."""

    found: Estimates  # one problem
    before: float  # root mean square, yaw at the mean distance of the feet [m]
    after: float  # as `settings` have it [m]

    @property
    def settings(self) -> Fitted:
        """Settings that were seen, with their standard errors."""
        (value,), (error,) = self.found.value, self.found.error
        mass, off = max(value[1], LIGHTEST), error[1]
        places = value[2:4] / mass
        errors = np.hypot(error[2:4], places * off) / mass
        x, y = value[4:6].tolist()
        steep, sideways = hypot(x, y), float(np.hypot(*error[4:6]))
        fitted: Fitted = {
            "friction": self.found.of(0),
            "payload": ([mass, *places.tolist(), 0.0], [off, *errors.tolist(), 0.0]),
            "slope": ([steep, atan2(y, x)], [sideways, sideways / max(steep, LEVEL)]),
            "servo_stiffness": self.found.of(6),
        }
        return {name: fitted[name] for name in _settings_of(self.found)}


@dataclass(frozen=True, eq=False)
class Walked:
    """Commands of a walk for the compliant prediction, and where the body went."""

    phases: Phases
    course: Course
    times: Array  # (T,) [s]
    pose: Array  # measured, in a frame of its own, (T, 3)
    arm: float  # mean distance of the feet from the body's centre [m]
    in_force: bool = False  # whether its commands have the servos' delay already

    @property
    def expected(self) -> Array:
        """`BODY` of the robot as it was described, (K,)."""
        robot = self.phases.robots
        friction, stiffness = robot.friction.mean(), np.log(robot.stiffness).mean()
        return np.array([friction, *np.zeros(len(BODY) - 2), stiffness])

    def follow(self, values: Array) -> Array:
        """Predicted poses (V, T, 3) of robots with other values (V, K) of `BODY`."""
        lanes = _changed(self.phases.robots, values)
        walks = Phases(self.phases.mechanics, lanes).follow_all(self.course)
        return np.stack([walk.at(self.times).pose for walk in walks])

    def missed(self, values: Array, rows: int) -> Array:
        """How far off such predictions are, yaw at the arm, (V, 3, T) [m].

        Nobody knows how the camera stands: it is moved so that some rows fit best.
        """
        x, y, _ = measured = _scaled(self.pose, self.arm)
        one, none = np.ones_like(x), np.zeros_like(x)
        moves = [[one, none, none], [none, one, none], [-y, x, self.arm * one]]
        found = np.stack([_scaled(pose, self.arm) for pose in self.follow(values)])
        off, frame = found - measured, np.array(moves)
        fitted = frame[..., :rows].reshape(len(frame), -1)
        best = off[..., :rows].reshape(len(off), -1) @ np.linalg.pinv(fitted)
        return np.asarray(off - np.tensordot(best, frame, axes=1))


def log_of(run: Run) -> Log:
    """A walk as a log without noise; delay and zeros are its servos', not commanded."""
    rows, joints, scenario = run.walking, run.card.joints, run.scenario
    ctrl = run.ctrl_at(run.time[rows] + scenario.command_delay)
    told = ctrl[:, actuators_driving(run.model, joints)]
    commanded = told - zero_offsets(scenario, len(joints))
    measured = turned(run.model, run.qpos[rows], joints, BACKLASH)
    time = run.time[rows] - run.time[rows][0]
    return Log(time, joints, commanded, measured, pose=run.achieved[rows])


def walked_of_run(run: Run, robot: Robot | None = None) -> Walked:
    """A finished run; the prediction knows none of its imperfections."""
    untold = replace(run, settings={**run.settings, "known": "none"})
    phases, course = course_of_run(untold, robot)
    rows = run.walking
    return Walked(phases, course, run.time[rows], run.achieved[rows], run.reach, True)


def walked_of_log(setup: Setup, log: Log) -> Walked:
    """A log with the body's pose; the robot first stands as in its first row.

    Rows without a pose say nothing. Raises ValueError where those are most of them.
    """
    motion, dt, pose = setup.motion, setup.limits.timestep, log.pose
    there = np.isfinite([[np.nan]] if pose is None else pose).all(axis=1)
    if motion is None or pose is None or np.mean(there) < 0.5:
        raise ValueError(message("few_poses"))
    hold = round(setup.limits.hold / dt)
    walked = motion.schedule(hold, hold + motion.steps)
    parts = [motion.schedule(0, hold, standing=True), walked]
    ctrl = np.concatenate([rows for part in parts for rows in setup.commands(part)])
    spans = np.array([(p.start, p.stop) for part in parts for p in part.phases])
    phases, none = phases_of(setup.as_planned), np.zeros(len(spans))
    course = course_along(setup, phases, ctrl, spans, none, {0: np.zeros(3)})
    times = hold * dt + log.time[there]
    return Walked(phases, course, times, pose[there], setup.kinematics.reach)


def fit_poses(walked: Walked) -> PoseFit:
    """Fit what moves the body of a walk to its poses, all but the last quarter.

    Raises MeasurementError where the prediction tips over.
    """
    rows = slice(None, None, max(len(walked.times) // MOMENTS, 1))
    walked = replace(walked, times=walked.times[rows], pose=walked.pose[rows])
    start, cut = walked.expected, int(FITTED * len(walked.pose))

    def model(values: Array) -> Array:  # all rows of x, then of y, then of yaw
        off = walked.missed(values[:, 0], cut)[..., :cut]
        return off.reshape(len(off), -1, 1)

    found = estimate(model, np.zeros((3 * cut, 1)), BODY, start[None], start[None])
    fitted = start.copy()
    for name in _settings_of(found):
        fitted[SETTINGS[name]] = found.value[0, SETTINGS[name]]
    off = walked.missed(np.stack([start, fitted]), cut)[..., cut:]
    before, after = np.sqrt((off**2).mean(axis=(1, 2)) * 3).tolist()
    return PoseFit(found, before, after)


def _settings_of(found: Estimates) -> list[str]:
    return [name for name, group in SETTINGS.items() if found.seen[0, group].any()]


def _scaled(pose: Array, arm: float) -> Array:
    """Poses (T, 3) from the first one, yaw at the arm, (3, T) [m]."""
    x, y, yaw = relative(pose[0], pose).T
    return np.stack([x, y, arm * np.unwrap(yaw)])


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
    return replace(
        lanes,
        friction=lanes.friction - lanes.friction.mean() + friction[:, None, None],
        body_mass=body,
        mass=lanes.mass + mass,
        body_center=moment / body[:, None],
        gravity=size * np.column_stack([tilt, -np.sqrt(1 - (tilt**2).sum(axis=1))]),
        stiffness=lanes.stiffness * np.exp(stiffness - usual)[:, None, None],
    )
