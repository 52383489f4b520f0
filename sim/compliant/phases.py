"""What a phase does to a robot, computed once for all phases that are alike.

Lifting a leg wipes out what its foot remembers, so the motion in a phase depends on the
commands of the last few seconds alone, and on the heading if the floor leans. Pieces
of a walk are computed side by side as lanes, and the walk is composed of its phases.
"""

from bisect import bisect, insort
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from math import ceil, sqrt
from typing import NamedTuple

import numpy as np

from models import MeasurementError
from planner import Array
from sim.compliant.anatomy import Robots
from sim.compliant.increment import LOADED, Mechanics
from sim.compliant.march import SLACK, Commands, Track, march
from sim.errors import message
from sim.motion.poses import compose, relative
from sim.motion.stability import carrying, stability_margin

REMEMBERED = 2.0  # [s] that feet remember; 1.5 is as good, 0.3 is not
SOON = 0.3  # [s]; lifts k times as long are remembered k^2.5 times as long, measured
ALIKE = 1e-5  # [rad]; commands closer than this do the same
NEAR = 1.001 * ALIKE  # so close their means are, beside rounding
SAME_HEADING = 0.02  # [rad], where gravity leans
LOOKED_AT = 4  # moments of a phase at which commands are compared
MOST_HELD = 10**8  # numbers of such commands, of all phases
LANES_WORTH = 40.0  # lanes that an increment of many costs as much as


class Motion(NamedTuple):
    """What a robot does at N moments; poses are relative to where it begins."""

    time: Array  # (N,) [s]
    pose: Array  # (N, 3), yaw not wrapped
    lean: Array  # height of the root [m], roll, pitch [rad], (N, 3)
    slip: Array  # of every foot so far, (N, F) [m]
    load: Array  # of every foot, (N, F) [N]
    torque: Array  # of every servo, (N, F, J) [N m]
    margin: Array  # along gravity, (N,) [m]

    def at(self, time: Array) -> "Motion":
        """Between its moments, at times (T,); of two moments at a time the first."""
        after = np.clip(np.searchsorted(self.time, time - 1e-9), 1, len(self.time) - 1)
        span = self.time[after] - self.time[after - 1]
        part = (time - self.time[after - 1]) / np.where(span > 0, span, 1.0)
        part = np.clip(part, 0.0, 1.0)

        def mixed(values: Array) -> Array:
            share = part.reshape(-1, *(1,) * (values.ndim - 1))
            return (1 - share) * values[after - 1] + share * values[after]

        return Motion(time, *(mixed(values) for values in self[1:]))


Motions = tuple[Motion, ...]  # of every robot, from the begin of a phase


class Likeness(NamedTuple):
    """What tells phases of one kind from those of others that last as long."""

    looks: Array  # commands of the phase and of those that are remembered, (n, F, J)
    heading: float  # of the body as it begins [rad]


Kind = tuple[Likeness, Motions]  # phases that are alike, and what happens in them


@dataclass(frozen=True, eq=False)
class Course:
    """The commands of a walk, its phases, and where it is taken to stand."""

    commands: Commands
    spans: Array  # first step of every phase and the one after its last, (P, 2)
    heading: Array  # of the body as each phase begins, a guess at first, (P,) [rad]
    restarts: Mapping[int, Array]  # poses (3,) at which the body stands by phase
    memory: float = REMEMBERED  # how long feet remember what they did [s]


@dataclass(frozen=True, eq=False)
class Phases:
    """Kinds of phases of robots in a world, known from earlier walks or computed.

    Further robots of the same anatomy walk the same commands beside the first one.
    """

    mechanics: Mechanics
    robots: Robots
    kinds: dict[tuple[int, ...], list[Kind]] = field(default_factory=dict)

    def follow(self, course: Course) -> Motion:
        """The motion of the first robot in a whole walk, as `follow_all` finds it."""
        return next(self.follow_all(course))

    def follow_all(self, course: Course) -> Iterator[Motion]:
        """The motion of every robot; where gravity leans, they head as the first does.

        Raises MeasurementError where one tips over, or no equilibrium is found.
        """
        for _ in range(3 if self.leans else 1):  # in which headings are corrected
            found = self._found(course)
            motion, headings = _composed(course, [motions[0] for motions in found])
            if np.abs(headings - course.heading).max(initial=0.0) <= SAME_HEADING:
                break
            course = replace(course, heading=headings)
        yield motion
        for other in range(1, len(self.robots.mass)):
            yield _composed(course, [motions[other] for motions in found])[0]

    @property
    def leans(self) -> bool:
        """Whether gravity has a direction along the floor."""
        return bool(self.robots.gravity[:, :2].any())

    def _found(self, course: Course) -> list[Motions]:
        """What every robot does in each phase; kinds that are new are computed."""
        known = {s: [like for like, _ in kinds] for s, kinds in self.kinds.items()}
        means = {
            shape: sorted((float(one.looks.mean()), i) for i, one in enumerate(alike))
            for shape, alike in known.items()
        }  # which are as near as the commands of phases that are alike
        where, new, held = [], [], 0
        for phase in range(len(course.spans)):
            shape, like = _window(course, phase)
            alike, order = known.setdefault(shape, []), means.setdefault(shape, [])
            mean = float(like.looks.mean())
            ends = bisect(order, (mean - NEAR, 0)), bisect(order, (mean + NEAR, 0))
            near = sorted(i for _, i in order[slice(*ends)])
            number = next((i for i in near if self._same(alike[i], like)), len(alike))
            if number == len(alike):
                alike.append(like)
                insort(order, (mean, number))
                new.append(phase)
                if (held := held + like.looks.size) > MOST_HELD:
                    raise MeasurementError(message("crowded", count=len(course.spans)))
            where.append((shape, number))
        for phase, motions in list(self._computed(course, new)):  # all, or none at all
            shape, number = where[phase]
            self.kinds.setdefault(shape, []).append((known[shape][number], motions))
        return [self.kinds[shape][number][1] for shape, number in where]

    def _same(self, one: Likeness, other: Likeness) -> bool:
        near = not self.leans or abs(one.heading - other.heading) <= SAME_HEADING
        return near and bool(np.abs(one.looks - other.looks).max() <= ALIKE)

    def _computed(
        self, course: Course, new: Sequence[int]
    ) -> Iterator[tuple[int, Motions]]:
        """What every robot does in new phases, walked in pieces side by side."""
        robots, spans = len(self.robots.mass), course.spans * course.commands.timestep
        pieces = list(_pieces(new, np.diff(spans)[:, 0] / course.memory, robots))
        if not pieces:
            return
        whose, which = np.divmod(np.arange(robots * len(pieces)), len(pieces))
        starts = np.array([_remembered(course, piece[0]) for piece in pieces])[which]
        track, ended, tipped = march(
            self.mechanics,
            self.robots.take(whose),
            course.commands,
            begin=spans[starts, 0],
            end=spans[[piece[-1] for piece in pieces], 1][which],
            yaw=course.heading[starts],
        )
        lane = int(ended.argmin())
        if np.isfinite(ended[lane]):
            why = "tips_over" if tipped[lane] else "no_equilibrium"
            raise MeasurementError(message(why, time=ended[lane]))
        whole = self._motion(track, whose)
        for number, piece in enumerate(pieces):
            own = range(number, robots * len(pieces), len(pieces))
            lanes = [Motion(*(part[track.of(n)] for part in whole)) for n in own]
            for phase in piece:
                yield phase, tuple(_during(lane, spans[phase]) for lane in lanes)

    def _motion(self, track: Track, whose: Array) -> Motion:
        """A track as motion in the world; slip is that of every increment."""
        R, own = track.turned, whose[track.lane]
        down = self.robots.gravity[own]
        yaw = np.arctan2(R[:, 1, 0], R[:, 0, 0])
        roll = np.arctan2(R[:, 2, 1], R[:, 2, 2])
        pitch = -np.arcsin(np.clip(R[:, 2, 0], -1, 1))
        height = track.place[:, 2] - self.mechanics.height
        above = height + track.center[:, 2]
        center = track.center[:, :2] - above[:, None] * (down[:, :2] / down[:, 2:])
        loaded = track.load > LOADED * self.robots.weight[own, None]
        stands = carrying(track.point, loaded, center)  # on some foot at every moment
        return Motion(
            time=track.time,
            pose=np.column_stack([track.place[:, :2], yaw]),
            lean=np.column_stack([height, roll, pitch]),
            slip=track.slip,
            load=track.load,
            torque=track.torque,
            margin=stability_margin(track.point, stands, center),
        )


def _window(course: Course, phase: int) -> tuple[tuple[int, ...], Likeness]:
    """A phase and what is remembered in it: its steps, and what else matters."""
    spans = course.spans[_remembered(course, phase) : phase + 1]
    steps = spans - spans[-1, 0]
    share = np.arange(1, LOOKED_AT + 1) / LOOKED_AT
    moments = spans[:, :1] + np.ceil(share * np.diff(spans)).astype(int)
    rows = np.append(spans[0, 0], moments.ravel() - 1)
    like = Likeness(course.commands.rows[rows], float(course.heading[phase]))
    return tuple(steps.ravel().tolist()), like


def _remembered(course: Course, phase: int) -> int:
    """The first phase that feet remember as another one begins."""
    begins = course.spans[: phase + 1, 0]
    steps = round(course.memory / course.commands.timestep)
    return max(int(np.searchsorted(begins, begins[-1] - steps, side="right")) - 1, 0)


def _pieces(new: Sequence[int], lasting: Array, robots: int) -> Iterator[list[int]]:
    """New phases that follow one another, in pieces that take the least time together.

    They last so many memories. As every piece begins as early as its first phase
    remembers, many pieces walk much twice, and few are more work for every lane.
    """
    total = float(lasting[list(new)].sum())
    longest = max(total / max(sqrt(LANES_WORTH / robots * total / 2), 1), 1.0)
    for _, run in groupby(enumerate(new), key=lambda item: item[1] - item[0]):
        phases = [phase for _, phase in run]
        ends = np.cumsum(lasting[phases])
        parts = ceil(ends[-1] / longest)
        part = np.minimum(((ends - SLACK) / ends[-1] * parts).astype(int), parts - 1)
        for number in np.unique(part):
            yield [phases[i] for i in np.flatnonzero(part == number)]


def _during(lane: Motion, span: Array) -> Motion:
    """A phase of a lane for itself: relative poses, and slip that adds up."""
    first, last = lane.time.searchsorted(span - SLACK)
    motion = Motion(*(part[first : last + 1] for part in lane))
    pose, slip = motion.pose.copy(), motion.slip.copy()
    pose[:, 2] = np.unwrap(pose[:, 2])
    slip[0] = 0.0  # of the increment that led there
    return motion._replace(
        time=motion.time - motion.time[0],
        pose=relative(pose[:1], pose),
        slip=np.cumsum(slip, axis=0),
    )


def _composed(course: Course, phases: Sequence[Motion]) -> tuple[Motion, Array]:
    """The motion of phases one after the other, and the headings they begin with."""
    pose, slip = np.zeros(3), np.zeros_like(phases[0].slip[0])
    begins = course.spans[:, 0] * course.commands.timestep
    parts, headings = [], []
    for phase, (begin, motion) in enumerate(zip(begins, phases, strict=True)):
        pose = course.restarts.get(phase, pose)
        headings.append(pose[2])
        moved = compose(pose, motion.pose)
        slid = slip + motion.slip
        parts.append(motion._replace(time=begin + motion.time, pose=moved, slip=slid))
        pose, slip = moved[-1], slid[-1]
    return Motion(*map(np.concatenate, zip(*parts, strict=True))), np.array(headings)
