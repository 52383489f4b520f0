"""Lower bounds on the stability margin and the clearance of the predicted motion.

The nominal path is divided so finely that the motion along it keeps the bounds of the
scenario. The planner decides how finely, from the slack that this module computes. The
motion is foreseen by the prediction that the scenario steers on.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import planner
from planner import Array, BoundError, Plan
from planner.planning import Slack, Step, grid
from planner.support import point, tick
from sim.errors import message
from sim.experiments.identification import twist_model
from sim.motion.prediction import Predictor, inspections
from sim.motion.stability import stability_margin
from sim.obstacles.clearance import Surroundings, surroundings
from sim.planning import open_loop
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup

NOMINAL_SAMPLES = 400  # of the nominal path, spread over its segments
Steps = dict[tuple[object, ...], Step]  # by where they begin, and what they aim at
FINEST_SEGMENT = 1e-3  # of the path; shorter segments would not be followed either


def within_bounds(setup: Setup) -> tuple[Setup, Plan | None]:
    """Divide the nominal path until the predicted motion keeps the scenario's bounds.

    The plan along the divided path comes with it, unless it is replanned from states
    that are not those of the prediction. Without bounds the scenario is left as it is.
    The error of bounds that cannot be kept says where, and what could be.
    """
    scenario, bounds = setup.scenario, list[Bound]()
    if scenario.min_margin is not None:
        bounds.append(MarginBound(scenario.min_margin))
    if scenario.obstacles and scenario.min_clearance >= 0:
        bounds.append(ClearanceBound(surroundings(setup), scenario.min_clearance))
    if not bounds:
        return setup, None
    trials = _Trials(setup, bounds)
    undivided = grid(scenario.path.curve, scenario.segments)
    cuts = planner.subdivide(undivided, trials.slacks)
    return setup.recut(cuts), trials.plan


class _Trials:
    """Divisions of a path that are tried, and the plan along the last of them."""

    def __init__(self, setup: Setup, bounds: Sequence["Bound"]) -> None:
        self.setup, self.bounds = setup, bounds
        self.plan: Plan | None = None
        self.known: Steps = {}

    def slacks(self, cuts: Array) -> list[Slack]:
        """Slack of every bound in each segment, or of what keeps it from a plan."""
        tried = self.setup.recut(cuts)
        try:
            return self._foreseen(tried)
        except planner.RangeError as error:
            if error.segments is None:
                raise
            return [_reach(tried)]  # without a plan there is no predicted motion
        except planner.ResolutionError as error:
            if np.diff(cuts)[list(error.segments)].min() < FINEST_SEGMENT:
                raise
            unresolved = np.zeros(len(cuts) - 1)
            unresolved[list(error.segments)] = 1.0
            return [_left_out("resolution", unresolved)]

    def _foreseen(self, tried: Setup) -> list[Slack]:
        if tried.scenario.replan:
            stages = list(foresee(tried, known=self.known))
            if tried.scenario.steered_on == "ideal":
                plans = [stage.plan for stage in stages if stage.plan]
                self.plan = open_loop.joined_plans(tried, plans)
            return self._along(tried, stages)
        for planned in open_loop.open_loop_plans(tried):
            self.plan = planned
            found = self._along(tried, list(foresee(tried, planned)))
            if any(slack.walking.min() < 0 for slack in found):
                break
        return found

    def _along(self, tried: Setup, stages: list["ForeseenStretch"]) -> list[Slack]:
        beyond = np.array([1 / stage.fraction - 1 for stage in stages])
        if beyond.any():
            return [_left_out("joint range", beyond)]
        moving = [stage for stage in stages if stage.predictor.schedule.phases]
        return [bound.slack(tried, moving) for bound in self.bounds]


def _reach(setup: Setup) -> Slack:
    """Slack of the joint range in each segment [rad]."""
    stability, segments = setup.equations.static_stability, setup.scenario.segments
    execution = planner.Execution(stance=setup.stance, static_stability=stability)
    asked = setup.extended, setup.nominal(), segments
    planned = planner.plan(*asked, execution=execution)
    shape, flows = setup.extended.shape, planned.flows
    lengths = np.diff(planned.segment_ends, prepend=0)
    segment = np.repeat(np.arange(len(lengths)), lengths)
    standing, walking = np.inf, np.full(len(planned.segment_ends), np.inf)
    for name, (low, high) in setup.equations.limits.items():
        angle = shape.trajectory(shape.names.index(name), flows, 0.0)[1:]
        np.minimum.at(walking, segment, np.minimum(high - angle, angle - low))
        standing = min(standing, high, -low)
    if walking.min() >= 0:  # only the steered plan leaves the range; divide its worst
        walking[walking.argmin()] = -1e-9  # [rad], just beyond
    return Slack("joint range", 0.0, np.full(len(walking), standing), walking, law=1.0)


def _left_out(bound: str, parts: Array) -> Slack:
    """Slack where parts of the segments are not followed for a reason."""
    return Slack(bound, 0.0, np.ones_like(parts), -parts, law=1.0)


@dataclass(frozen=True)
class ForeseenStretch:
    """A stretch of commands and the motion predicted for it."""

    predictor: Predictor
    fraction: float = 1.0  # of its way; below 1 if the joint range cuts it short
    plan: Plan | None = None  # of the segment, where each is planned for itself

    @cached_property
    def rows(self) -> Array:
        """Steps to inspect: the end of every phase, and even distances before it."""
        schedule = self.predictor.schedule
        return inspections(schedule) - 1 - schedule.start

    def segment(self, rows: Array) -> Array:
        """Segment that determines the configuration at each step, shape (T,).

        Before its first swing it is the previous one, which left the legs as they are.
        """
        schedule, deciding, swung = self.predictor.schedule, [], -1
        for phase in schedule.phases:
            if phase.kind == "swing":
                swung = phase.segment
            deciding.append(max(phase.segment - (phase.segment != swung), 0))
        return np.array(deciding)[schedule.phase_of(rows)]


def foresee(
    setup: Setup, planned: Plan | None = None, known: Steps | None = None
) -> Iterator[ForeseenStretch]:
    """The stretches of a walk in time order: its plan, or without one each segment.

    Every segment is taken to end at its predicted pose, on ideal fields that of the
    exact kinematics. One that the joint range cuts short is taken to reach its target.
    Steps that are known are not planned again, and those that were not are added.
    """
    twists = twist_model(setup, setup.scenario.steered_on)
    if planned is not None:
        schedule = scheduled(setup, planned.segments())
        yield ForeseenStretch(Predictor(schedule, twists, setup.kinematics))
        return
    legs, (pose, swing) = setup.at_rest, open_loop.split(setup, setup.nominal()(0.0))
    segments, known = setup.scenario.segments, {} if known is None else known
    for segment in range(segments):
        tick()
        target = open_loop.segment_target(setup, segment)
        asked = pose.tobytes(), swing, target.tobytes(), segment + 1 == segments
        step = known.get(asked) or open_loop.plan_segment(setup, segment, pose, swing)
        known[asked] = step
        schedule = scheduled(setup, step.plan.segments(), legs, segment)
        predictor = Predictor(schedule, twists, setup.kinematics, tuple(pose))
        yield ForeseenStretch(predictor, step.fraction, step.plan)
        legs = schedule.end
        if setup.scenario.steered_on == "ideal":
            pose, swing = open_loop.split(setup, planner.rollout(step.plan)[-1])
        elif schedule.phases:
            last = np.array([schedule.stop - schedule.start - 1])
            pose, swing = predictor.configurations(last)[0][0], legs.swing
        if step.fraction < 1:
            pose = target


@dataclass(frozen=True)
class MarginBound:
    """The stability margin stays above a least value [m]."""

    least: float

    def slack(self, setup: Setup, stages: Sequence[ForeseenStretch]) -> Slack:
        """Margins of the predicted motion, compared with the largest possible ones."""
        margins = np.full(setup.scenario.segments, np.inf)
        for stage in stages:
            segment = stage.segment(stage.rows)
            np.minimum.at(margins, segment, stage.predictor(stage.rows).margin)
        standing = np.ones_like(margins)
        if margins.min() < self.least:
            # The gait's least stable stratum with legs at angle 0, and its margin [m].
            strata, lift = tuple(setup.raised), np.array(list(setup.raised.values()))
            stance = setup.kinematics.stance(np.zeros_like(lift), lift)
            contact = np.array([setup.robot.planted(stratum) for stratum in strata])
            margin = stability_margin(stance.feet, contact, stance.center_of_mass)
            stratum, most = strata[int(margin.argmin())], float(margin.min())
            if most <= self.least:
                raise self._refusal(stratum, most, float(margins.min()))
            standing[:] = most - self.least
        return Slack("min_margin", self.least, standing, margins - self.least, unit="m")

    def _refusal(self, stratum: str, standing: float, walking: float) -> BoundError:
        what = "margin_walking" if walking > standing else "margin_standing"
        facts = {"walking": walking, "standing": standing, "stratum": stratum}
        return BoundError(message(what, least=self.least, **facts))


@dataclass(frozen=True)
class ClearanceBound:
    """The robot's outline keeps a least distance from all obstacles [m]."""

    surroundings: Surroundings
    least: float

    def slack(self, setup: Setup, stages: Sequence[ForeseenStretch]) -> Slack:
        """Clearance of the swept outline, compared with that of the nominal path."""
        walking = np.full(setup.scenario.segments, np.inf)
        for stage in stages:
            np.minimum.at(walking, stage.segment(stage.rows[:-1]), self.swept(stage))
        room, left = np.ones_like(walking), walking - self.least
        if (short := np.flatnonzero(left < 0)).size:
            room[short] = self._standing(setup, short) - self.least
        return Slack("min_clearance", self.least, room, left, unit="m")

    def _standing(self, setup: Setup, where: Array) -> Array:
        """Clearance along some segments of the nominal path on any stratum [m]."""
        samples = 1 + -(-NOMINAL_SAMPLES // (segments := setup.scenario.segments))
        inner = (where[:, None] + np.linspace(0, 1, samples)) / segments
        poses = setup.scenario.path.curve.at(inner.ravel())
        least = np.full(len(poses), np.inf)
        for stratum, raised in setup.raised.items():
            qpos = self.surroundings.postures(poses, raised)
            clearance = self.surroundings.clearances(qpos).least
            at = int(clearance.argmin())
            if clearance[at] <= self.least:
                raise self._refusal(stratum, poses[at], qpos[at], clearance[at])
            least = np.minimum(least, clearance)
        return least.reshape(-1, samples).min(axis=1)

    def _refusal(
        self, stratum: str, pose: Array, qpos: Array, clearance: float
    ) -> BoundError:
        part, obstacle = self.surroundings.nearest(qpos)
        facts = {"part": part, "obstacle": obstacle, "place": point(pose)}
        facts |= {"room": 1e3 * clearance, "least": 1e3 * self.least}
        facts |= {"missing": 1e3 * (self.least - clearance), "stratum": stratum}
        return BoundError(message("room", **facts))

    def swept(self, stage: ForeseenStretch) -> Array:
        """A lower bound on the clearance after each row but the last, (T - 1,) [m]."""
        return self._between(stage, np.stack([stage.rows[:-1], stage.rows[1:]], axis=1))

    def _between(self, stage: ForeseenStretch, pairs: Array) -> Array:
        """A lower bound of the clearance between pairs of rows, shape (K, 2).

        Exact where it is below `least`; intervals are halved until that is decided.
        """
        rows, where = np.unique(pairs, return_inverse=True)
        configurations = stage.predictor.configurations(rows)
        qpos = self.surroundings.outline.configurations(*configurations)
        clear = self.surroundings.clearances(qpos, self.least)
        begin, end = where.reshape(-1, 2).T
        seen = np.minimum(clear.least[begin], clear.least[end])
        bound = np.minimum(seen, clear.between(begin, end))
        open_ = (np.diff(pairs)[:, 0] > 1) & (bound < self.least) & (seen >= self.least)
        if open_.any():
            middle = pairs[open_].mean(axis=1).astype(int)
            first, last = pairs[open_].T
            halves = np.transpose([[first, middle], [middle, last]], (0, 2, 1))
            found = self._between(stage, halves.reshape(-1, 2))
            bound[open_] = found.reshape(2, -1).min(axis=0)
        return np.where(seen < self.least, seen, bound)


Bound = MarginBound | ClearanceBound
