"""Servo commands: intended angles with feed-forward, zero offsets, counts and delay.

Between two updates of the servos a command is held. The intended angles remain those of
the schedule, which all predictions follow.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, floor

import numpy as np

from models import SERVO_KINDS
from models.description import actuators_driving
from planner import Array
from planner.support import shipped_tables
from sim.drive.feed_forward import FeedForward, carried_torque
from sim.drive.lift_counts import LiftCounts
from sim.errors import SimulationError, UsageError
from sim.logs.playing import Played
from sim.motion.schedule import Schedule, command_at, step_of
from sim.physics.engine import STRETCH
from sim.preparation.setup import Setup
from sim.scenarios.scenario import Scenario
from sim.world.servos import ServoSettings, servo_settings

Allowed = tuple[FeedForward | None, FeedForward | None]  # torques, practised angles
MESSAGES = shipped_tables("sim.drive", "refusals.toml")
LEAST_FRICTION = 0.1  # below, feet slide whatever the servos do


class Drive:
    """Commands of one walk, stretch after stretch."""

    def __init__(self, setup: Setup) -> None:
        self._setup, self._servo = setup, setup.servo
        model, joints = setup.model, setup.robot.card.joints
        self._joints = actuators_driving(model, joints)
        self._stiffness = model.actuator_gainprm[self._joints, 0]
        self._damping = -model.actuator_biasprm[self._joints, 2]
        self._offset = zero_offsets(setup.scenario, len(self._joints))
        scenario = setup.scenario
        self._delay = round(scenario.command_delay / scenario.timestep)  # steps
        self._held: Array | None = None  # the command in force
        self._late: Array | None = None  # commands that have not reached the servos
        self._rest = np.array([setup.robot.standing_angle(j) for j in joints])
        self._lifts = [joints.index(joint) for joint in setup.robot.lift_joints]
        self._lift_counts = LiftCounts(setup.as_planned, self.feeds_forward)

    @property
    def plain(self) -> bool:
        """Whether the commands are the intended angles and nothing else."""
        servo, delay = self._servo, self._delay
        changed = servo.rate or servo.resolution or self._offset.any() or delay
        return not (changed or self.practises or self.feeds_forward)

    @property
    def feeds_forward(self) -> bool:
        """Whether commands make up for the angles by which loads bend the servos."""
        return self._servo.feeds_forward(float(self._stiffness.min()))

    @property
    def practises(self) -> bool:
        """Whether commands make up for slack, for which the walk is practised."""
        return self._setup.scenario.as_assumed.is_imperfect

    @property
    def rehearsed(self) -> bool:
        """Whether the torques of the walk are measured beforehand."""
        return self.feeds_forward or self._servo.torque is not None

    def require_gentleness(self) -> None:
        """Refuse commands so far apart in time that their jumps make feet slip."""
        scenario, stiffness = self._setup.scenario, float(self._stiffness.max())
        share = self._jump(self._servo, stiffness)
        if share <= 1:
            return
        held = self._held_torque()
        slower = 0.95 * scenario.swing_speed / share  # two digits add 5 % at most
        rate, name = self._servo.rate, scenario.name
        facts = {"jump": share * held, "held": held, "slower": slower}
        more = {"stiffness": stiffness, "faster": ceil(rate * share)}
        raise UsageError(*_message("gentle", rate=rate, scenario=name, **facts, **more))

    def _jump(self, servo: ServoSettings, stiffness: float) -> float:
        """Jump of a torque from one command to the next, as a share of what is held."""
        planned = self._setup.motion is None  # or played as it is
        speed = planned * self._setup.scenario.swing_speed
        return stiffness * speed / (servo.rate or np.inf) / self._held_torque()

    def _held_torque(self) -> float:
        """Torque that friction holds at the end of a leg [N m]."""
        friction = max(self._setup.scenario.friction, LEAST_FRICTION)
        return friction * carried_torque(self._setup)

    def require_strength(self, schedule: Schedule, torques: FeedForward) -> None:
        """Refuse a stretch that needs more torque than a servo has at its speed."""
        most = self._servo.torque
        if most is None:
            return
        rows = np.arange(len(torques.values)) * torques.spacing
        turned = np.abs(self._speed(schedule, rows))
        self._require_pace(turned.max(axis=0))
        borne = np.abs(torques.values[:, self._joints])
        needed = _needed(self._servo, borne, turned)
        knot, joint = np.unravel_index(needed.argmax(), needed.shape)
        if needed[knot, joint] <= most:
            return
        phase = schedule.phases[int(schedule.phase_of(rows[[knot]])[0])]
        name = self._setup.robot.card.joints[joint]
        seconds = (schedule.start + rows[knot]) * self._setup.limits.timestep
        pauses = np.array([phase.start - schedule.start for phase in schedule.phases])
        at_rest = np.abs(torques.at(pauses)[:, self._joints[joint]]).max()
        makes = self._sufficient(borne, turned)
        slower = phase.kind == "swing" and at_rest < most and not self._setup.motion
        suited = f"take servos that suit this walk, --set servo={' or '.join(makes)}"
        stronger = "take stronger servos than all that are known by name"
        remedies = [suited if makes else stronger, "make the robot lighter"]
        remedies += ["lower swing_speed"] * bool(slower)
        facts = {"phase": phase, "seconds": seconds, "at_rest": at_rest, "most": most}
        what, where = _message("weak", joint=name, needed=needed[knot, joint], **facts)
        setting = f"servo={makes[0]}" if makes else ""
        raise SimulationError(what, where, ", or ".join(remedies), setting)

    def _sufficient(self, borne: Array, turned: Array) -> list[str]:
        """Makes that would walk a stretch, by torques and speeds, the weakest first."""
        setup, strong = self._setup, list[tuple[float, str]]()
        for name in SERVO_KINDS:
            scenario = replace(setup.scenario, servo=name)
            servo = servo_settings(scenario, setup.robot.card)
            most, kind = servo.torque or 0.0, servo.kind
            slow = kind is not None and 0 < kind.profile_speed < turned.max()
            gentle = self._jump(servo, servo.stiffness or 0.0) <= 1
            if gentle and not slow and _needed(servo, borne, turned).max() <= most:
                strong.append((most, name))
        return [name for _, name in sorted(strong)]

    def _require_pace(self, speeds: Array) -> None:
        """Refuse speeds of the joints, (J,) [rad/s], that servos are not set to."""
        kind, setup = self._servo.kind, self._setup
        if kind is None or not 0 < (most := kind.profile_speed) < speeds.max():
            return
        counts, slower = ceil(speeds.max() / kind.resolution / 50) * 50, {}
        if np.delete(speeds, self._lifts).max(initial=0.0) > most:
            slower["swing_speed"] = most
        if (lifted := speeds[self._lifts].max()) > most:
            angle = most / lifted * setup.limits.lift_angle
            slower["lift_height"] = setup.kinematics.rise(angle).min()
        sets = [f"--set {name}={floor(1e3 * x) / 1e3:g}" for name, x in slower.items()]
        asked = "" if setup.motion else f", or {' '.join(sets)}"
        facts = {"servo": self._servo.name, "counts": counts, "asked": asked}
        facts |= {"speed": speeds.max(), "set_to": counts * kind.resolution}
        raise UsageError(*_message("fast", most=most, **facts))

    def require_reach(self, schedule: Schedule, torques: FeedForward | None) -> None:
        """Refuse predicted feed-forward that a joint's range would cut short."""
        if torques is None or self._servo.feed_forward != "predicted":
            return
        model, joints = self._setup.model, self._joints
        rows = np.arange(len(torques.values)) * torques.spacing
        ctrl = self._ctrl(schedule, (torques, None), rows)[:, joints]
        low, high = model.actuator_ctrlrange[joints].T
        limited = model.actuator_ctrllimited[joints].astype(bool)
        beyond = np.where(limited, np.maximum(low - ctrl, ctrl - high), -np.inf)
        knot, joint = np.unravel_index(beyond.argmax(), beyond.shape)
        if beyond[knot, joint] <= 0:
            return
        name = model.actuator(int(joints[joint])).name
        seconds = (schedule.start + rows[knot]) * self._setup.limits.timestep
        facts = {"angle": ctrl[knot, joint], "low": low[joint], "high": high[joint]}
        raise SimulationError(*_message("beyond", joint=name, seconds=seconds, **facts))

    def commands(
        self,
        schedule: Schedule,
        torques: FeedForward | None,
        steps: int | None = None,
        practised: FeedForward | None = None,
    ) -> Iterator[Array]:
        """Rows of ctrl of a stretch, or of its first steps, (n, nu), n to `STRETCH`.

        What was practised is added to the angles of the joints, (J,) [rad].
        """
        if self.plain:
            yield from self._setup.commands(schedule, steps)
            return
        count = schedule.stop - schedule.start if steps is None else steps
        for begin in range(0, count, STRETCH):
            rows = np.arange(begin, min(begin + STRETCH, count))
            given = self._held_commands(schedule, (torques, practised), rows)
            if self._late is None:  # the first one is there from the start
                self._late = np.repeat(given[:1], self._delay, axis=0)
            both = np.concatenate([self._late, given])
            self._late = both[len(given) :]
            yield both[: len(given)]

    def _held_commands(self, schedule: Schedule, ahead: Allowed, rows: Array) -> Array:
        """Each command in force from the step at which it is given to the next one."""
        given = schedule.start + rows  # step of the command in force in each step
        if self._servo.rate:
            pace = self._servo.rate * self._setup.limits.timestep  # commands a step
            given = step_of(command_at(given, pace), pace)
        given, row = np.unique(given, return_inverse=True)
        fresh = given >= schedule.start
        ctrl = np.empty((len(given), self._setup.model.nu))
        ctrl[fresh] = self._ctrl(schedule, ahead, given[fresh] - schedule.start)
        if self._held is None:
            self._held = self._ctrl(schedule, ahead, np.zeros(1, dtype=int))[0]
        ctrl[~fresh] = self._held
        self._held = ctrl[-1].copy()
        return np.ascontiguousarray(ctrl[row])

    def _ctrl(self, schedule: Schedule, ahead: Allowed, rows: Array) -> Array:
        """Commands that are given at steps of a schedule, shape (n, nu)."""
        rehearsed, practised = ahead
        channels, joints, lifts = self._setup.channels, self._joints, self._lifts
        ctrl = channels.ctrl(schedule.targets(self._setup.robot, rows))
        lag = bent = np.zeros((len(rows), len(joints)))
        if rehearsed is not None:
            lag = self._damping * self._speed(schedule, rows) / self._stiffness
            bent = rehearsed.at(rows)[:, joints] / self._stiffness
        ctrl[:, joints] += bent + lag
        if practised is not None:
            ctrl[:, joints] += practised.at(rows)
        if resolution := self._servo.resolution:
            rest = self._rest / resolution  # on a count, so that strokes end on some
            counts = np.round(ctrl[:, joints] / resolution - rest) + np.round(rest)
            if not (isinstance(schedule, Played) or self._lift_counts.fine):
                lift, loads = schedule.angles(rows)[1], None
                if rehearsed is not None:
                    loads = bent[:, lifts]
                counts[:, lifts] = self._lift_counts.at(lift, lag[:, lifts], loads)
            ctrl[:, joints] = counts * resolution
        ctrl[:, joints] += self._offset
        angles = zip(self._setup.robot.card.joints, ctrl[:, joints].T, strict=True)
        return channels.ctrl(dict(angles))

    def _speed(self, schedule: Schedule, rows: Array) -> Array:
        """Intended speed of the joints by differences, (n, J) [rad/s]."""
        last = schedule.stop - schedule.start - 1
        ahead, behind = np.minimum(rows + 1, last), np.maximum(rows - 1, 0)
        robot, channels = self._setup.robot, self._setup.channels
        later, sooner = (
            channels.ctrl(schedule.targets(robot, step))[:, self._joints]
            for step in (ahead, behind)
        )
        seconds = np.maximum(ahead - behind, 1) * self._setup.limits.timestep
        return (later - sooner) / seconds[:, None]


def _message(problem: str, /, **facts: object) -> list[str]:
    """What is wrong, where, and what to do, as `refusals.toml` says it."""
    return [part.format(**facts) for part in MESSAGES[problem]]


def _needed(servo: ServoSettings, borne: Array, turned: Array) -> Array:
    """Torque that servos need to have [N m], of which speed takes its share.

    What is left falls linearly with speed [rad/s], to none at no load.
    """
    return borne + (servo.torque or 0.0) / (servo.speed or np.inf) * turned


def zero_offsets(scenario: Scenario, joints: int) -> Array:
    """Error of each servo's zero, (J,) [rad]; the same for the same draw."""
    spread = scenario.zero_offset
    if isinstance(spread, tuple):
        return np.array(spread)
    return np.random.default_rng(scenario.draw).uniform(-spread, spread, joints)
