"""What commands depend on: torques that a walk takes, and practice with slack.

Torques are walked or predicted beforehand, on very stiff servos and without the
imperfections of the walking robot, stretch by stretch.

A tripod has one free motion, about its pivot, which its swing servos alone hold. Loads
push it across dead bands and backlash, and the yaw adds up. A robot with the assumed
slack walks each stretch several times, and commands shift by a part of what is missed.
"""

from copy import copy
from dataclasses import replace

import numpy as np

from planner import Array
from sim.compliant.prediction import Leg, course_of, phases_of
from sim.drive.drive import Allowed, Drive
from sim.drive.feed_forward import FeedForward, smoothed, stiffened
from sim.motion.poses import wrap
from sim.motion.schedule import Schedule
from sim.physics.engine import Engine
from sim.preparation.setup import Setup
from sim.world.imperfections import BACKLASH, turned

WELL_MET = 0.002  # of the reach, that a turn may miss the end by for practice to end
PART = 0.7  # of what was missed, that is added after a turn


class Rehearsal:
    """A second robot that walks every stretch beforehand."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup.as_planned
        self._engine = Engine(stiffened(self._setup))

    def torques(self, schedule: Schedule) -> FeedForward:
        """Walk a schedule and return the torques that it took."""
        torques = [
            self._engine.advance(ctrl).actuator_force
            for ctrl in self._setup.commands(schedule)
        ]
        return smoothed(np.concatenate(torques), self._setup.limits.timestep)


class Foreseen:
    """The compliant prediction of every stretch, in place of a rehearsal."""

    def __init__(self, setup: Setup) -> None:
        planned = setup.as_planned
        self._setup = replace(
            planned, model=stiffened(planned), servo=replace(planned.servo, rate=0.0)
        )
        self._phases = phases_of(self._setup)
        self._legs: list[Leg] = []
        self._rows: list[Array] = []

    def torques(self, schedule: Schedule) -> FeedForward:
        """Predict a schedule after those before it and return the torques it takes."""
        self._legs.append(Leg(schedule, np.zeros(3)))
        if waited := schedule.start - sum(map(len, self._rows)):
            self._rows.append(np.repeat(self._rows[-1][-1:], waited, axis=0))
        self._rows += list(self._setup.commands(schedule))
        course = course_of(self._setup, self._phases, self._legs, self._rows)
        steps = 1 + np.arange(schedule.start, schedule.stop)
        dt, anatomy = self._setup.limits.timestep, self._phases.mechanics.anatomy
        found = self._phases.follow(course).at(steps * dt).torque
        torques = np.zeros((len(steps), self._setup.model.nu))
        real = anatomy.axis.any(axis=-1)
        torques[:, anatomy.actuator[real]] = found[:, real]
        return smoothed(torques, dt)


class Practised:
    """A robot that walks stretches to find the angles of its legs, slack included."""

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self.drive, self.engine = Drive(setup), Engine(setup.model)

    def walk(
        self, schedule: Schedule, made: FeedForward | None, shifts: FeedForward | None
    ) -> tuple[FeedForward, Array]:
        """Angles of all leg joints along a schedule, and the pose after it."""
        model, joints = self.setup.model, self.setup.robot.card.joints
        rows = [
            turned(model, qpos, joints, BACKLASH)
            for ctrl in self.drive.commands(schedule, made, practised=shifts)
            for qpos in [self.engine.advance(ctrl).qpos]
        ]
        pose = self.setup.pose(self.engine.state.qpos)
        return smoothed(np.concatenate(rows), self.setup.limits.timestep), pose


class Practice:
    """A robot with slack that practises to walk like one without."""

    def __init__(self, setup: Setup) -> None:
        assumed, joints = setup.scenario.as_assumed, len(setup.robot.card.joints)
        self._tight = Practised(setup.as_planned)
        self._loose = Practised(setup.with_imperfections(assumed))
        self._width = np.broadcast_to(assumed.dead_band, joints) + assumed.backlash
        self._shift = _half_counts(setup, self._width)

    def shifts(self, schedule: Schedule, made_up: FeedForward | None) -> FeedForward:
        """What to add to the commands of a schedule, (J,) [rad], at most the slack.

        It is that of the turn which ends nearest to the robot without slack.
        """
        wanted, goal = self._tight.walk(schedule, made_up, None)
        loose, reach = self._loose, self._loose.setup.kinematics.reach
        began, drive = loose.engine.moment, loose.drive
        shift, tried = np.zeros_like(wanted.values), []
        for turn in range(8):  # at most: they need not converge, the best is taken
            loose.engine.rewind(began)
            loose.drive = copy(drive)
            shifts = replace(wanted, values=shift)
            reached, pose = loose.walk(schedule, made_up, shifts)
            off = pose - goal
            miss = float(np.hypot(*off[:2]) + reach * abs(wrap(off[2])))
            tried.append((miss, shifts, loose.engine.moment, loose.drive))
            if turn and miss <= WELL_MET * reach:
                break
            missed = wanted.values + self._shift - reached.values
            shift = np.clip(shift + PART * missed, -self._width, self._width)
        _, best, moment, loose.drive = min(tried[1:], key=lambda one: one[0])
        loose.engine.rewind(moment)
        return best


def _half_counts(setup: Setup, width: Array) -> Array:
    """Half a count for each swing joint whose slack is nearer to an odd number, (J,).

    A joint rests at half its slack from its command; strokes end on whole counts.
    """
    robot, resolution = setup.robot, setup.servo.resolution
    shift = np.zeros(len(width))
    if resolution:
        swings = [robot.card.joints.index(joint) for joint in robot.swing_joints]
        odd = np.round(width[swings] / resolution) % 2
        shift[swings] = odd * resolution / 2 * np.sign(robot.swing_gain)
    return shift


class Beforehand:
    """What commands depend on, stretch by stretch; too much torque is refused."""

    def __init__(self, setup: Setup, drive: Drive) -> None:
        self._drive = drive
        known = Foreseen if setup.servo.feed_forward == "predicted" else Rehearsal
        self._rehearsal = known(setup) if drive.rehearsed else None
        self._practice = Practice(setup) if drive.practises else None

    def feed_forward(self, schedule: Schedule) -> Allowed:
        """Torques that commands make up for, and what was practised."""
        made_up = None
        if schedule.start == schedule.stop:  # there is nothing to walk
            return None, None
        if self._rehearsal is not None:
            rehearsed = self._rehearsal.torques(schedule)
            self._drive.require_strength(schedule, rehearsed)
            made_up = rehearsed if self._drive.feeds_forward else None
        if self._practice is None:
            return made_up, None
        return made_up, self._practice.shifts(schedule, made_up)
