"""The commands that the servos receive: intended angles with lead, offsets and counts.

Commands are held between the moments at which the servos are updated. The intended
angles remain those of the schedule, which all predictions follow.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

import numpy as np

from planner import Array
from sim.drive.lead import Lead
from sim.drive.lift_counts import LiftCounts
from sim.drive.rehearsal import carried_torque, leg_actuators
from sim.errors import SimulationError, UsageError
from sim.motion.command_clock import command_at, step_of
from sim.motion.schedule import Schedule
from sim.physics.engine import STRETCH
from sim.preparation.setup import Setup

LEAST_FRICTION = 0.1  # below, feet slide whatever the servos do


class Drive:
    """Commands of one walk, stretch after stretch."""

    def __init__(self, setup: Setup) -> None:
        self._setup, self._servo = setup, setup.servo
        self._joints = leg_actuators(setup)
        model = setup.model
        self._stiffness = model.actuator_gainprm[self._joints, 0]
        self._damping = -model.actuator_biasprm[self._joints, 2]
        self._offset = _zero_offsets(setup, len(self._joints))
        self._held: Array | None = None
        self._late: Array | None = None  # commands on their way to the servos
        self._lifts = _lift_places(setup)
        self._lift_counts = LiftCounts(setup.as_planned, self.leads)

    @property
    def plain(self) -> bool:
        """Whether servos are told the intended angles and nothing else."""
        servo = self._servo
        bent = self.leads or bool(self._offset.any()) or self._delay > 0
        return not (servo.rate or servo.resolution or bent)

    @property
    def _delay(self) -> int:
        """Steps from a command to its effect."""
        scenario = self._setup.scenario
        return round(scenario.command_delay / scenario.timestep)

    @property
    def leads(self) -> bool:
        """Whether commands lead by what the load bends."""
        return self._servo.leads(float(self._stiffness.min()))

    @property
    def rehearsed(self) -> bool:
        """Whether the torques of the walk must be known beforehand."""
        return self.leads or self._servo.torque is not None

    def require_gentleness(self) -> None:
        """Refuse commands so far apart that every one of them kicks the robot loose.

        Between two commands a joint falls behind, and the next one hurls it forward
        with the servo's stiffness. While that is less than what friction holds at the
        end of a leg, the feet stay where they are.

        Raises:
            UsageError: Saying which rate would do.
        """
        scenario, stiffness = self._setup.scenario, float(self._stiffness.max())
        if not self._servo.rate:
            return
        kick = stiffness * scenario.swing_speed / self._servo.rate
        held = max(scenario.friction, LEAST_FRICTION) * carried_torque(self._setup)
        if kick <= held:
            return
        raise UsageError(
            f"each of {self._servo.rate:g} commands a second changes the torque of a "
            f"servo of {stiffness:g} N m/rad by {kick:.2g} N m, and friction holds "
            f"{held:.2g} N m",
            f"scenario {scenario.name!r}",
            f"raise command_rate to {ceil(self._servo.rate * kick / held)}, lower "
            f"swing_speed, or set servo_stiffness to {stiffness * held / kick:.0f}",
        )

    def require_strength(self, schedule: Schedule, lead: Lead) -> None:
        """Refuse a stretch that asks a servo for more torque than it has.

        Raises:
            SimulationError: Naming the joint, the phase and the torque.
        """
        most = self._servo.torque
        if most is None:
            return
        rows = np.arange(len(lead.torque)) * lead.spacing
        lost = most / (self._servo.speed or np.inf)  # with speed [N m s/rad]
        turned = np.abs(self._speed(schedule, rows))
        needed = np.abs(lead.torque[:, self._joints]) + lost * turned
        knot, joint = np.unravel_index(needed.argmax(), needed.shape)
        if needed[knot, joint] <= most:
            return
        phase = schedule.phases[int(schedule.phase_of(rows[[knot]])[0])]
        name = self._setup.model.actuator(int(self._joints[joint])).name
        seconds = (schedule.start + rows[knot]) * self._setup.limits.timestep
        raise SimulationError(
            f"servo {name!r} would need {needed[knot, joint]:.3g} N m in a "
            f"{phase.kind} on S{phase.stratum} and has {most:.3g} N m",
            f"t = {seconds:.2f} s",
            "choose a stronger servo, a lighter robot, or a lower swing_speed",
        )

    def commands(
        self, schedule: Schedule, lead: Lead | None, steps: int | None = None
    ) -> Iterator[Array]:
        """Rows of ctrl of one stretch, shape (n, nu), n to `STRETCH`.

        Args:
            schedule: Intended angles.
            lead: Torques to lead by, if any.
            steps: How many of its steps; all if not given.
        """
        if self.plain:
            yield from self._setup.commands(schedule, steps)
            return
        count = schedule.stop - schedule.start if steps is None else steps
        for begin in range(0, count, STRETCH):
            rows = np.arange(begin, min(begin + STRETCH, count))
            yield self._delayed(self._held_commands(schedule, lead, rows))

    def _delayed(self, told: Array) -> Array:
        """Rows as they reach the servos; the first one is there from the start."""
        if self._late is None:
            self._late = np.repeat(told[:1], self._delay, axis=0)
        both = np.concatenate([self._late, told])
        self._late = both[len(told) :]
        return both[: len(told)]

    def _held_commands(
        self, schedule: Schedule, lead: Lead | None, rows: Array
    ) -> Array:
        """Each command from its own step on, until the next one comes."""
        given, row = np.unique(self._given(schedule.start + rows), return_inverse=True)
        fresh = given >= schedule.start
        told = np.empty((len(given), self._setup.model.nu))
        told[fresh] = self._told(schedule, lead, given[fresh] - schedule.start)
        if self._held is None:
            self._held = self._told(schedule, lead, np.zeros(1, dtype=int))[0]
        told[~fresh] = self._held
        self._held = told[-1].copy()
        return np.ascontiguousarray(told[row])

    def _given(self, steps: Array) -> Array:
        """Step at which the command came that holds during each step."""
        if not self._servo.rate:
            return steps
        pace = self._servo.rate * self._setup.limits.timestep  # commands a step
        return step_of(command_at(steps, pace), pace)

    def _told(self, schedule: Schedule, lead: Lead | None, rows: Array) -> Array:
        """Commands that are given at steps of a schedule, shape (n, nu)."""
        channels, joints = self._setup.channels, self._joints
        swing, lift = schedule.angles(rows)
        told, lag = channels.ctrl(swing, lift), np.zeros((len(rows), len(joints)))
        if lead is not None:
            lag = self._damping * self._speed(schedule, rows) / self._stiffness
            told[:, joints] += lead.at(rows)[:, joints] / self._stiffness + lag
        if resolution := self._servo.resolution:
            counts = np.round(told[:, joints] / resolution)
            counts[:, self._lifts] = self._lift_counts.at(lift, lag[:, self._lifts])
            told[:, joints] = counts * resolution
        told[:, joints] += self._offset
        return told

    def _speed(self, schedule: Schedule, rows: Array) -> Array:
        """Intended speed of the joints at steps of a schedule, (n, J) [rad/s]."""
        last = schedule.stop - schedule.start - 1
        ahead, behind = np.minimum(rows + 1, last), np.maximum(rows - 1, 0)
        later, sooner = (
            self._setup.channels.ctrl(*schedule.angles(step))[:, self._joints]
            for step in (ahead, behind)
        )
        seconds = np.maximum(ahead - behind, 1) * self._setup.limits.timestep
        speed: Array = (later - sooner) / seconds[:, None]
        return speed


def _zero_offsets(setup: Setup, joints: int) -> Array:
    """By how much each servo's zero is off, (J,) [rad]; the same for the same draw."""
    spread = setup.scenario.zero_offset
    if isinstance(spread, tuple):
        return np.array(spread)
    return np.random.default_rng(setup.scenario.draw).uniform(-spread, spread, joints)


def _lift_places(setup: Setup) -> Array:
    """Which of the leg joints' actuators lift, legs in ascending order."""
    joints = setup.robot.card.joints
    return np.array([joints.index(joint) for joint in setup.robot.lift_joints])
