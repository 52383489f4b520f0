"""The paper's hexapod in the paper's units (l = 1), walked on its exact kinematics.

It has neither a body nor forces: eqs. (16) to (18) are integrated along a plan's flows.
A bracket of size h needs strokes of size sqrt(h) (eq. 20), so that the tube in which a
segment stays around the nominal path is as wide as the square root of its length.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import shapely

from models import paper_hexapod
from models.morphology import FEET, PIVOT, PIVOTS
from models.systems import AIR_SWINGS
from planner import Array, Path, Plan, line, plan, rollout
from planner.execution import Execution
from sim.motion.poses import rotate

Fields = Literal["paper", "lifted"]

ELEMENTS: Mapping[Fields, tuple[str, ...]] = {
    "paper": ("g12_1", "g12_2", *AIR_SWINGS, "[g12_1,g12_2]"),
    "lifted": ("g1_1", "g2_2", *AIR_SWINGS, "[g1_1,g2_2]"),
}
FLOW_STATES = 12  # states drawn a flow, enough for arcs of a radian


@dataclass(frozen=True)
class PaperWalk:
    """A plan and the states it leads through."""

    plan: Plan
    states: Array  # start, then `samples` a flow, (1 + samples * flows, 5)
    samples: int

    @property
    def ends(self) -> Array:
        """Index of the state that closes each segment, shape (segments,)."""
        return self.samples * np.array(self.plan.segment_ends)

    @property
    def segment(self) -> Array:
        """Index of the segment that each state belongs to, from 0."""
        return np.searchsorted(self.ends, np.arange(len(self.states)))

    @property
    def share(self) -> Array:
        """Part of the segments done at each state, from 0 to 1, shape (N,)."""
        ends = np.concatenate([[0], self.ends])
        done = np.linspace(0, 1, len(ends))
        return np.interp(np.arange(len(self.states)), ends, done)

    @property
    def error(self) -> float:
        """Distance of the end from the goal in the plane."""
        return float(np.hypot(*(self.states[-1] - self.plan.goal)[:2]))


def walk(
    path: Path, segments: int, *, fields: Fields = "paper", samples: int = FLOW_STATES
) -> PaperWalk:
    """Plan a path of (x, y, theta, phi_1, phi_2) in the paper's order and walk it.

    The fields are the paper's own, or those that never swing a tripod beside a loaded
    one; the body walks the same way.
    """
    backward = Execution(coordinates="backward")
    system, elements = paper_hexapod(heights=False).system, ELEMENTS[fields]
    planned = plan(system, path, segments, elements, execution=backward)
    return PaperWalk(planned, rollout(planned, samples), samples)


def configuration(pose: Sequence[float]) -> Array:
    """A pose with legs at angle 0, shape (5,)."""
    return np.array([*pose, 0.0, 0.0])


def feet(walked: PaperWalk) -> Array:
    """All feet on the ground plane, shape (N, 6, 2).

    A foot that stands still under eq. (17) is carried around its tripod's pivot, the
    point (0, 1) or (0, -1) of the body. Feet and pivots are those of the robot
    `hexapod`, measured in its pivots' distance.
    """
    x, y, yaw, *phi = walked.states.T
    places = np.empty((len(walked.states), len(FEET), 2))
    for leg, at in FEET.items():
        pivot = np.array(PIVOTS[leg]) / PIVOT
        turned = -phi[0] if pivot[1] > 0 else phi[1]
        arm = np.array(at) / PIVOT - pivot
        places[:, leg - 1] = pivot + rotate(np.tile(arm, (len(x), 1)), turned)
    return rotate(places, yaw[:, None]) + np.stack([x, y], axis=-1)[:, None]


def standing(walked: PaperWalk) -> Array:
    """Which feet are on the ground at each state, shape (N, 6), bool."""
    tripod = np.array(["1" if PIVOTS[leg][1] > 0 else "2" for leg in FEET])
    strata = np.repeat([flow.stratum for flow in walked.plan.flows], walked.samples)
    return np.array([[t in s for t in tripod] for s in ("12", *strata)])


@dataclass(frozen=True)
class Tube:
    """How a straight line is followed, by the number of its segments."""

    segments: Array  # ascending, (K,)
    length: Array  # of one segment, (K,)
    width: Array  # largest distance from the line, (K,)
    turn: Array  # largest departure from the line's heading, (K,) [rad]
    error: Array  # distance of the end from the goal, (K,)


def follow(
    goal: Sequence[float], segments: int, samples: int = FLOW_STATES
) -> PaperWalk:
    """Walk straight to a goal at constant heading on the paper's kinematics."""
    path = line(configuration((0, 0, 0)), configuration(goal))
    return walk(path, segments, samples=samples)


def tube(goal: Sequence[float], segments: Sequence[int]) -> Tube:
    """Walk the line in different numbers of segments."""
    walks = [follow(goal, n, samples=2) for n in segments]
    # produced beyond its ends: going past the goal is not leaving the line
    produced = np.outer([-1.0, 2.0], goal[:2])
    widths = [swing_out(w.states[:, :2], w.ends, produced).max() for w in walks]
    turn = np.array([np.abs(w.states[:, 2]).max() for w in walks])
    count, error = np.array(segments), np.array([w.error for w in walks])
    return Tube(count, np.linalg.norm(goal[:2]) / count, np.array(widths), turn, error)


def swing_out(points: Array, ends: Array, nominal: Array) -> Array:
    """Largest distance of points, (N, 2), from a chain, (M, 2), by segment."""
    distance = shapely.distance(shapely.points(points), shapely.LineString(nominal))
    return np.array([values.max() for values in by_segment(distance, ends)])


def envelope(points: Array, ends: Array, goal: Sequence[float] | Array) -> Array:
    """Points farthest right and left of a line from 0, (2, segments, 2), of (N, 2)."""
    left = by_segment(points @ np.array([-goal[1], goal[0]]), ends)
    spans = list(zip(by_segment(points, ends), left, strict=True))
    return np.array([[p[c(off)] for p, off in spans] for c in (np.argmin, np.argmax)])


def by_segment(values: Array, ends: Array) -> list[Array]:
    """The rows of each segment, that of its end among them and that of its start."""
    return [values[a : b + 1] for a, b in pairwise([0, *ends])]


def exponent(lengths: Array, widths: Array) -> float:
    """Power by which widths grow with lengths: the slope through their logarithms."""
    return float(np.polyfit(np.log(lengths), np.log(widths), 1)[0])
