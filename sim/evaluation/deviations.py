"""Distances of poses from others and from the nominal path, and sources of the error.

Let the first k phases move the body as achieved and the remaining ones as predicted.
From k to k + 1 the end moves by the contribution of phase k, so that all contributions
add up to the error exactly. They are summed by stratum and kind of phase.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from models import IdentifiedTwists, MeasurementError, TwistModel
from planner import Array, Path
from sim.errors import message
from sim.evaluation import summary
from sim.motion.poses import compose, path_deviation, relative, wrap
from sim.motion.prediction import Prediction
from sim.preparation.shared import Cache, no_cache
from sim.scenarios import predictions
from sim.scenarios.body_path import SHORTEST_WAY, NominalPath
from sim.walking.finished import Walk

SWAY = 0.25  # of the feet's distance from the middle
LEAST_WAY = 0.01  # of that distance
COMPARED = 1500  # poses that are compared with the path, evenly taken from all


def deviation_from(curve: Path, poses: Array) -> summary.Departure:
    """Farthest that poses, in time order, come from a path and from its yaw."""
    rows = np.linspace(0, len(poses) - 1, min(len(poses), COMPARED)).round().astype(int)
    return summary.Departure(**path_deviation(curve, poses[rows])._asdict())


def deviations(
    walk: Walk, caches: Mapping[str, Cache], poses: Mapping[str, Array]
) -> dict[str, summary.Departure | None]:
    """Farthest from the path and from its yaw: planned, quasi-static and achieved.

    A plan is of the prediction it steers on, an optimised one never of the ideal one.
    """
    scenario = walk.setup.scenario
    if walk.setup.motion is not None:
        return {}
    planned = predictions.prediction_key(scenario.steer)
    if planned == predictions.IDEAL.key and scenario.optimise != "none":
        planned = predictions.QUASI_STATIC.key

    def farthest(name: str) -> summary.Departure | None:
        if name not in poses:
            return None
        found = partial(deviation_from, scenario.path.curve, poses[name])
        return caches.get(name, no_cache)(f"deviation {name}", found)

    others = predictions.QUASI_STATIC.key, "achieved"
    return {"planned": farthest(planned)} | {name: farthest(name) for name in others}


def sensed(walk: Walk) -> summary.Sensed | None:
    """What feedback thinks; None if nothing was told, or all of it was exact."""
    followed = walk.followed
    if followed is None or followed.feedback.sensing.is_exact:
        return None
    last = followed.stops[-1]
    wrong = departure(np.array(last.expected), np.array(last.true))
    (claimed, claimed_yaw), (least, least_yaw) = followed.claimed, followed.bound
    return summary.Sensed(
        thought=list(last.expected),
        wrong=wrong.position,
        wrong_yaw=wrong.yaw,
        claimed=claimed,
        claimed_yaw=claimed_yaw,
        bound=least,
        bound_yaw=least_yaw,
        sees_position=followed.feedback.sensing.sees_position,
    )


def per_metre(length: float, seconds: float, strokes: float) -> summary.PerMetre:
    """Time and strokes of the loaded groups [rad] per metre of the nominal path."""
    if max(seconds, strokes) >= 1e9 * length:  # which no run folder holds
        return summary.PerMetre()
    return summary.PerMetre(seconds=seconds / length, strokes=strokes / length)


def departure(pose: Array, other: Array) -> summary.Departure:
    """How far a pose is from another one."""
    apart = pose - other
    far = float(np.hypot(*apart[:2]))
    return summary.Departure(position=far, yaw=float(abs(wrap(apart[2]))))


def off(
    poses: Array, others: Array, length: float, walked: float
) -> summary.PredictionError:
    """How far a motion (T, 3) is from another one at its end, and at most on the way.

    Ratios to lengths of path and way [m] are None where these are nothing.
    """
    at_end = departure(poses[-1], others[-1])
    return summary.PredictionError(
        **at_end,
        position_per_path=at_end.position / length if length else None,
        position_per_walked=at_end.position / walked if walked > SHORTEST_WAY else None,
        farthest=float(np.hypot(*(poses - others)[:, :2].T).max()),
    )


def predicted_way(poses: Array, reach: float) -> float:
    """Length of the way that is predicted of a motion that is played, (T, 3) [m].

    Swaying within a quarter of the feet's distance from the middle is no way, nor is
    what comes to less than a hundredth of it.
    """
    mark, length = poses[0, :2], 0.0
    for place in poses[:, :2]:
        if (step := float(np.hypot(*(place - mark)))) >= SWAY * reach:
            mark, length = place, length + step
    length += float(np.hypot(*(poses[-1, :2] - mark)))
    yaw = np.unwrap(poses[:, 2])
    length = max(length, reach * abs(float(yaw[-1] - yaw[0])))
    return length if length >= LEAST_WAY * reach else 0.0


@dataclass(frozen=True)
class Scale:
    """What distances on a walk are weighed by."""

    prediction: str  # key of the one that the walk is judged by
    radius: float  # mean distance of the feet from the middle [m]
    length: float  # of the path; where it only turns, of the feet's way [m]

    @classmethod
    def of(cls, path: NominalPath, reach: float, made: Collection[str]) -> "Scale":
        """That of walks along a path, by the best of the predictions that were made."""
        turns = np.diff(path.curve.at(np.linspace(0, 1, COMPARED))[:, 2])
        way = path.length or reach * float(np.abs(turns).sum())
        return cls(predictions.best(made), reach, way if way > SHORTEST_WAY else 0.0)

    def weigh(
        self, poses: Array, predicted: Array, goal: Sequence[float] | None
    ) -> summary.Weighed:
        """Poses (T, 3) against the prediction (T, 3) on the way and a goal, (3,)."""
        end, wanted = poses[-1], [] if goal is None else [np.array(goal, dtype=float)]
        ends = [departure(end, pose) for pose in (predicted[-1], *wanted)]
        near = all(
            o.position <= summary.NEAR * self.length and o.yaw <= summary.DEGREE
            for o in ends
        )
        return summary.Weighed(
            **vars(self),
            goal=self.share(end, wanted[0], near) if wanted else None,
            ended=self.share(end, predicted[-1], near),
            farthest=self.share(poses, predicted, near),
        )

    def share(self, poses: Array, others: Array, near: bool = False) -> float:
        """The largest distance between poses (..., 3) as a share of the length, if any.

        Yaw counts at the feet, and not at all if they are near one another.
        """
        apart = poses - others
        turned = 0.0 if near else self.radius * wrap(apart[..., 2])
        far = np.hypot(np.hypot(apart[..., 0], apart[..., 1]), turned)
        return float(far.max()) / self.length if self.length else 0.0


def contributions(achieved: Array, predicted: Array) -> Array:
    """What each phase contributes to the final pose error, shape (P, 3).

    Given are poses at the start and at the end of each phase, shape (P + 1, 3); yaw may
    be wrapped. The sum is achieved[-1] - predicted[-1]: the first phase has what they
    differ by at its start.
    """
    was, meant = (np.c_[p[:, :2], np.unwrap(p[:, 2])] for p in (achieved, predicted))
    ends = compose(was, relative(meant, meant[-1]))  # as predicted, from each pose on
    return np.diff(ends[1:], axis=0, prepend=meant[-1:])


def error_sources(
    walk: Walk, achieved: Array, prediction: Prediction
) -> dict[str, list[float]]:
    """Contributions to the final error by kind and stratum, as `swing S1`.

    Args:
        walk: An open-loop walk.
        achieved: Achieved pose at every moment recorded, shape (T, 3).
        prediction: Prediction at the same moments.

    Returns:
        For each source its part in x, y [m] and yaw [rad].

    Example:
        >>> from sim import error_sources, load_scenario, simulate
        >>> short = {"segments": 2, "path.goal": [0.01, 0.01, 0.0]}
        >>> found = simulate(load_scenario("line", short)).evaluation
        >>> ideal = found.predicted["ideal"]
        >>> sources = error_sources(found.walk, found.achieved.pose, ideal)
        >>> "swing S1" in sources
        True
    """
    phases = [phase for phase in walk.phases if phase.start >= walk.starts]
    edges = np.array([phases[0].start, *(phase.stop for phase in phases)])
    at = walk.recording.moments.step.searchsorted(edges)  # ends of phases are recorded
    parts = contributions(achieved[at], prediction.pose[at])
    sources: dict[str, Array] = {}
    for phase, part in zip(phases, parts, strict=True):
        name = f"{phase.kind} S{phase.stratum}"
        sources[name] = sources.get(name, 0.0) + part
    return {name: part.tolist() for name, part in sources.items()}


def require_holding(
    walk: Walk, name: str, made: Callable[[], TwistModel], strata: Collection[str]
) -> None:
    """Refuse a measured prediction whose misses of single strokes may add up to much.

    They add up along the way, which is several times as long as the path. A prediction
    that is steered on is kept; else MeasurementError says why it is left out.
    """
    scenario, length, off = walk.setup.scenario, walk.setup.scenario.path.length, 0.0
    if name != predictions.IDENTIFIED.key or scenario.steered_on == name:
        return
    if isinstance(twists := made(), IdentifiedTwists):
        fields = (f for f in twists.fields.values() if f.stratum in strata)
        off = max((field.off for field in fields), default=0.0)
    if length and off * walk.distance > 0.05 * length:  # of the path
        share = 100 * off * walk.distance / length
        raise MeasurementError(message("untrusted", share=share))
