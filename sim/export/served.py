"""A walk for a robot that is not simulated: commands at their rate, segment by segment.

Each segment is planned from where feedback thinks the robot is. It is told of no
imperfection; what segments miss is learnt from the poses that come back.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from models import Robot
from models.description import actuators_driving
from planner import Array
from sim.drive.drive import Drive
from sim.drive.rehearsal import Beforehand
from sim.errors import UsageError
from sim.export.servo_commands import taken
from sim.export.servo_table import require_limits
from sim.feedback.stops import Stop, stop_after
from sim.motion.schedule import Schedule, Scheduler
from sim.preparation.scheduling import check_effort, schedule_flows
from sim.preparation.setup import Setup, prepare
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.scenario import Scenario
from sim.walking.walks import expected_steps, next_segment

SERVO_RATE = 50.0  # commands a second where the servos have no rate, as most take
Row = tuple[float, Array]  # time [s], and the angle of every joint [rad]

IN_PIECES: dict[str, tuple[str | int | None, ...]] = {
    "optimise": ("none",),
    "steer": ("ideal", "quasi-static", "identified"),
    "correct": (1,),
    "motion": (None,),
}  # what settings for whole paths may be where each piece is planned on its own


class ServedWalk:
    """A walk whose commands for `joints` go elsewhere, from where its poses come.

    Its `stops` are what feedback made of each segment so far; `scaled_down` counts
    the segments that were cut to the range of the joints.
    """

    def __init__(self, setup: Setup) -> None:
        check_effort(setup, expected_steps(setup, None))
        self.setup, self.feedback = setup, setup.feedback()
        self.rate = setup.servo.rate or SERVO_RATE
        self.joints = tuple(setup.robot.card.joints)
        self.stops: list[Stop] = []
        self.scaled_down = 0
        self._actuators = actuators_driving(setup.model, self.joints)
        self._drive = Drive(setup)
        self._drive.require_gentleness()
        self._beforehand = Beforehand(setup, self._drive)
        self._legs, self._steps, self._given = setup.at_rest, 0, 0
        self._last = np.zeros(len(self.joints))
        self._began, self._meant = 0.0, np.zeros(3)

    @property
    def time(self) -> float:
        """When the next command is given [s]."""
        return self._given / self.rate

    def stand(self) -> Iterator[Row]:
        """Commands that keep the robot where it is, for the scenario's hold."""
        scheduler = self._scheduler()
        scheduler.hold(self.setup.limits.hold)
        yield from self._rows(scheduler.finish())

    def wait(self) -> Row:
        """The last command once more, at the time of the next one."""
        row = self.time, self._last
        self.skip(1)
        return row

    def skip(self, count: int) -> None:
        """Let the times of some commands pass, meanwhile the robot stands."""
        self._given += count
        pace = self.rate * self.setup.limits.timestep
        self._steps = max(self._steps, round(self._given / pace))

    def walk(self, segment: int) -> Iterator[Row]:
        """Commands of the next segment, planned from where the robot is thought."""
        self._began, swing = self.time, self._legs.swing
        step, self._meant = next_segment(self.setup, self.feedback, segment, swing)
        self.scaled_down += step.fraction < 1
        scheduler = self._scheduler()
        scheduler.segment = segment
        schedule_flows(self.setup, scheduler, step.plan.segments())
        yield from self._rows(scheduler.finish())

    def seen(self, segment: int, pose: Sequence[float]) -> Stop:
        """Tell feedback what was seen after a segment: x, y, yaw, NaN if it was not."""
        gyro = np.nan if np.isfinite(self.feedback.sensing.yaw) else pose[2]
        now, reading = self.time, np.array([*pose, gyro])
        unknown = np.full(3, np.nan)  # nobody knows where a real robot truly is
        moved = now - self._began, self._meant
        stop = stop_after(self.feedback, segment, now, *moved, reading, unknown)
        self.stops.append(stop)
        return stop

    def _scheduler(self) -> Scheduler:
        return Scheduler(self.setup.limits, self._legs, self._steps)

    def _rows(self, schedule: Schedule) -> Iterator[Row]:
        torques, practised = self._beforehand.feed_forward(schedule)
        self._legs, self._steps = schedule.end, schedule.stop
        rows = [*self._drive.commands(schedule, torques, practised=practised)]
        if not rows:
            return
        how = self.joints, self._actuators, self.rate, self.setup.limits.timestep
        commands = taken(np.concatenate(rows), *how)
        require_limits(self.setup.robot.card, commands)
        for angles in commands.angles:
            self._last = angles
            yield self.time, angles
            self._given += 1


def served(scenario: Scenario, robot: Robot | None = None) -> ServedWalk:
    """A served walk, planned in pieces, of a robot without known imperfections.

    Its path is that of a replanned walk: around obstacles, and divided to keep bounds.
    """
    for key, allowed in IN_PIECES.items():
        if (value := getattr(scenario, key)) not in allowed:
            where = f"scenario {scenario.name!r}"
            raise UsageError.of("piecewise", where, key=key, value=value)
    setup = prepare(scenario, robot)
    known = setup.scenario
    learn = True if scenario.learn is None else scenario.learn
    band = known.as_assumed.dead_band  # for which commands allow, a number by now
    plain = replace(known.as_planned, assumed_dead_band=band)  # type: ignore[arg-type]
    asked = replace(plain, replan=True, learn=learn)
    bare = replace(setup.robot, card=replace(setup.robot.card, fitted={}))  # known now
    return ServedWalk(ScenarioProblem.ready(prepare(asked, bare)).setup)
