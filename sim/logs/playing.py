"""Joint motion as a schedule: the log's commands, with contacts planned from them.

Its phases are the times in which the same feet stand. A played motion has no flows; all
else that is done with a schedule is done with it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import compress
from pathlib import Path

import numpy as np

from models import Ground, Kinematics, Robot
from planner import Array
from sim.errors import UsageError, message
from sim.logs.feet import Posture, moved, posture
from sim.logs.log import Log
from sim.motion.poses import wrap
from sim.motion.prediction import Commanded, Prediction
from sim.motion.schedule import Kind, LegState, MotionLimits, Phase, Schedule
from sim.motion.stability import stability_margin
from sim.scenarios.file import scenario_from
from sim.scenarios.scenario import Scenario

LOOKS_APART = 0.005  # [s] between moments at which feet are looked at
MOST_LOOKS = 20_000  # of these moments
BEYOND = 1e-3  # [rad] beyond a joint's range that is told
SHORTEST_CONTACT = 0.02  # [s] of a contact, or of its interruption, that is planned


@dataclass(frozen=True, eq=False)
class Motion:
    """What a robot is to do by a log, and which of its feet are to stand meanwhile."""

    log: Log
    robot: Robot
    limits: MotionLimits

    @cached_property
    def time(self) -> Array:
        """Moments that are looked at, evenly spaced, (N,) [s]."""
        count = min(int(np.ceil(self.log.duration / LOOKS_APART)), MOST_LOOKS)
        return np.linspace(0.0, self.log.duration, count + 1)

    @cached_property
    def posture(self) -> Posture:
        """Feet at these moments."""
        return posture(self.robot, self.log.joints, self.log.at(self.time))

    @cached_property
    def contact(self) -> Array:
        """Feet planned to stand at these moments, (N, F), bool; the lowest, if none."""
        standing = self.posture.standing
        shortest = round(SHORTEST_CONTACT / (self.time[1] - self.time[0]))
        for foot in standing.T:
            edges = np.flatnonzero(np.diff(foot)) + 1
            for begin, end in zip(edges[:-1], edges[1:], strict=True):
                if end - begin < shortest and foot[begin - 1] != foot[begin]:
                    foot[begin:end] = foot[begin - 1]
        standing |= self._lowest & ~standing.any(axis=1, keepdims=True)
        return standing

    @property
    def _lowest(self) -> Array:
        return self.posture.height <= self.posture.near

    @property
    def low(self) -> Array:
        """Feet that are down in the first row's posture, (F,), bool."""
        return self.contact[0] | self._lowest[0]

    @cached_property
    def margin(self) -> Array:
        """Stability margin of the level body at these moments, (N,) [m]."""
        center = self.posture.center_of_mass[:, :2]
        return stability_margin(self.posture.feet[..., :2], self.contact, center)

    def schedule(self, begin: int, end: int, *, standing: bool = False) -> "Played":
        """Commands of steps from one to another, or of `standing` in the first row."""
        rest = LegState((0.0,) * len(self.robot.groups), self.robot.card.bottom)
        held = (self._phase("hold", self.low, begin, end, np.zeros(1)),)
        phases = held if standing else tuple(self._swings(begin, end))
        return Played(phases, rest, rest, self.limits, self, standing)

    @property
    def steps(self) -> int:
        """Physics steps that it takes."""
        return round(self.log.duration / self.limits.timestep) + 1

    def _swings(self, begin: int, end: int) -> Iterator[Phase]:
        dt = self.limits.timestep
        apart = max(round(LOOKS_APART / dt), 1)
        changes = np.flatnonzero(np.diff(self.contact, axis=0).any(axis=1)) + 1
        rows = [0, *changes.tolist()]
        starts = [begin + round(self.time[row] / dt) for row in rows]
        for row, first, last in zip(rows, starts, [*starts[1:], end], strict=True):
            looks = dt * np.arange(first - begin, last - begin + 1, apart)
            if last > first:
                yield self._phase("swing", self.contact[row], first, last, looks)

    def _phase(
        self, kind: Kind, standing: Array, start: int, stop: int, looks: Array
    ) -> Phase:
        """A phase whose joints move as the log commands at times of it [s]."""
        feet, card = tuple(standing.tolist()), self.robot.card
        ways = np.abs(np.diff(self.log.at(looks), axis=0)).sum(axis=0)
        of_joint = dict(zip(self.log.joints, ways.tolist(), strict=True))
        swung = [
            [of_joint.get(card.legs[leg].swing, 0.0) for leg in group.legs]
            for group in card.groups.values()
        ]
        known = kind, self._name(feet), tuple(sum(own) / len(own) for own in swung)
        return Phase(*known, 1.0, start, stop - start, segment=0, feet=feet)

    def _name(self, feet: tuple[bool, ...]) -> str:
        """The stratum of whole groups that stand, else the legs that do."""
        groups, of = self.robot.groups, self.robot.group_of_leg
        name = "".join(g for i, g in enumerate(groups) if all(np.array(feet)[of == i]))
        if (self.robot.planted(name) == feet).all():
            return name
        return f"legs {' '.join(str(leg) for leg in compress(self.robot.legs, feet))}"


@dataclass(frozen=True)
class Played(Schedule):
    """A schedule whose commands are those of a log."""

    motion: Motion
    standing: bool

    def targets(self, robot: Robot, rows: Array) -> Mapping[str, Array]:
        """Commanded angles of the log's joints at steps (T,), by joint, (T,) [rad]."""
        log = self.motion.log
        return dict(zip(log.joints, log.at(self._time(rows)).T, strict=True))

    def commanded(self, rows: Array, kinematics: Kinematics) -> Commanded:
        """Planned contacts and margin at steps (T,); groups have no angles."""
        motion, phase = self.motion, self.phase_of(rows)
        contact = np.array([p.feet for p in self.phases], dtype=bool)[phase]
        margin = np.interp(self._time(rows), motion.time, motion.margin)
        swing = np.zeros((len(rows), len(kinematics.robot.groups)))
        return Commanded(phase, swing, contact, margin)

    def _time(self, rows: Array) -> Array:
        """Time of the log at steps of the schedule, (T,) [s]."""
        return np.asarray(rows * (0.0 if self.standing else self.limits.timestep))


def rigid(
    motion: Motion, ground: Ground, contact: Array, margin: Array, time: Array
) -> Prediction:
    """Rigid quasi-static motion at times (T,) of the log [s], negative before it."""
    grid = motion.time
    pose, slip = moved(motion.posture, motion.contact, ground, grid[1] - grid[0])
    x, y, yaw, *slid = (np.interp(time, grid, n) for n in (*pose.T, *slip.T))
    place = np.stack([x, y, wrap(yaw)], axis=1)
    return Prediction(place, np.stack(slid, axis=1), margin, contact)


def within_reach(log: Log, robot: Robot) -> Log:
    """The log, and in `done` which joint it commands farthest beyond its range."""
    ends = np.array([robot.span(joint) for joint in log.joints]).T
    low, high = np.where(np.abs(ends) < np.pi, ends, np.inf * ends)  # or no end at all
    beyond = np.maximum(low - log.commanded, log.commanded - high)
    row, joint = np.unravel_index(beyond.argmax(), beyond.shape)
    if beyond[row, joint] <= BEYOND:
        return log
    angle, moment = log.commanded[row, joint], log.time[row]
    facts = {"joint": log.joints[joint], "low": low[joint], "high": high[joint]}
    line = message("beyond", angle=angle, moment=moment, **facts)
    return replace(log, done=(*log.done, line))


def posed(robot: Robot, log: Log) -> Robot:
    """The robot that stands in the first row's posture."""
    at = dict(zip(log.joints, log.commanded[0].tolist(), strict=True))
    legs = {
        number: replace(leg, hold={j: at.get(j, held) for j, held in leg.hold.items()})
        for number, leg in robot.card.legs.items()
    }
    card = replace(robot.card, legs=legs, start={**robot.card.start, **at})
    return replace(robot, card=card)


def scenario_of(robot: Robot, file: Path, settings: Mapping[str, object]) -> Scenario:
    """The scenario that plays a file on a robot; commands are given as they stand."""
    for key in settings.keys() & {"robot", "motion"}:
        raise UsageError(f"{key} is given twice", f"--set {key}", "keep one")
    name = "".join(c if c.isalnum() or c in "-_" else "-" for c in file.stem)
    table = {
        "name": name.strip("-") or "motion",
        "robot": robot.name if robot.is_shipped else str(robot.path.absolute()),
        "motion": str(file.absolute()),
        "segments": 1,
        "feed_forward": False,
    }
    return scenario_from(table, settings, str(file))
