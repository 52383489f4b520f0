"""Groups of legs that can stand, the posture in which each has a pivot, and its swings.

All legs of a group move the body about one point without slip exactly where the legs,
produced inward, meet at that point: the group's pivot. Legs are turned until they do,
and legs farther from the pivot swing farther, in proportion, and in ratios of small
whole numbers where a pivot nearby allows it. How far groups swing before their parts
touch is found on a grid of both angles, on the ground and lifted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from itertools import chain, combinations, product
from typing import NamedTuple

import mujoco
import numpy as np

from models.adoption.anatomy import Limb, Pose
from models.contact.loads import static_loads
from models.errors import ModelError
from planner import Array

PLACES = 25  # along each side of the field in which pivots are looked for
MOST_SWING = 0.45  # [rad] either way, of the leg that swings farthest
LEAST_SWING = 0.1  # [rad] either way, of a group
LEAST_LOAD = 0.06  # share of the weight on each foot of a group that stands
MOST_WAYS = 12  # pairs of groups that are tried
MOST_PAIRS = 200  # pairs of pivots of each
NEIGHBOUR_DISTANCE = 0.6  # of that between feet, which turned legs keep
MOST_PARTS = 4  # into which the gain of the leg that swings farthest is divided
MOST_CHANGE = 0.1  # of a gain, for which a pivot is moved
NEWTON_STEPS, IN_STEP = 8, 1e-9  # and how near to what is wanted gains then are

Groups = tuple[tuple[int, ...], tuple[int, ...]]


@dataclass(frozen=True)
class Stand:
    """A group's legs turned towards a pivot."""

    legs: tuple[int, ...]  # their places among the limbs
    pivot: Array  # where their lines meet, shape (2,) [m]
    turns: Array  # how far each leg is turned from how it stands, anticlockwise [rad]
    gains: Array  # swing of each leg per angle of the group, at most 1
    yaw: float  # turn of the body per radian of the group
    swing: float  # how far the group swings either way [rad]
    feet: Array  # where the feet are then, shape (legs, 2) [m]


def two_groups(limbs: Sequence[Limb], weight: Array, source: str) -> list[Groups]:
    """Ways to make two groups of legs that each stand alone, the surest first."""
    feet = np.array([limb.toe[:2] for limb in limbs])
    count, sure = len(limbs), []
    for size in range(2, count - 3):
        for group in combinations(range(1, count), size):
            one = (0, *group)
            other = tuple(i for i in range(count) if i not in one)
            least = min(_surety(feet[list(g)], weight) for g in (one, other))
            if least >= LEAST_LOAD:
                sure.append((least, one, other))
    if not sure:
        raise ModelError(
            f"no two groups of its {count} legs can stand alone in turn: {source}; its "
            "weight is not inside the feet of one while the others are lifted"
        )
    sure.sort(key=lambda way: -round(way[0], 6))
    return [(group, other) for _, group, other in sure[:MOST_WAYS]]


def _surety(feet: Array, weight: Array) -> float:
    """Least share of the weight on any of some feet; 0 where they do not balance it."""
    loads = static_loads(feet[None], weight[None])[0]
    balanced = np.abs(loads @ feet - weight).max() < 1e-6
    return float(loads.min()) if balanced else 0.0


def posed(
    limbs: Sequence[Limb],
    ways: Sequence[Groups],
    weight: Array,
    ranges: Array,
    source: str,
) -> tuple[Stand, Stand]:
    """The pair of pivots from which the robot goes farthest sideways.

    The preferred groups come first; ranges say how far each leg may turn clockwise and
    anticlockwise from how it stands, shape (legs, 2) [rad]. Turned legs keep apart as
    they did before.
    """
    from scipy.spatial.distance import pdist  # slow to import, and seldom needed

    feet = np.array([limb.toe[:2] for limb in limbs])
    for groups in ways:
        first, second = (list(_stands(limbs, g, weight, ranges)) for g in groups)
        if not first or not second:
            continue
        worth = _worth(first, second)
        for place in np.argsort(-worth, axis=None)[:MOST_PAIRS]:
            i, j = np.unravel_index(place, worth.shape)
            one, other = (
                _in_step(limbs, stand, weight, ranges)
                for stand in (first[i], second[j])
            )
            after = feet.copy()
            for stand in (one, other):
                after[list(stand.legs)] = stand.feet
            if pdist(after).min() > NEIGHBOUR_DISTANCE * pdist(feet).min():
                return one, other
    raise ModelError(
        f"its legs cannot be turned so that they meet at pivots: {source}; each group "
        "can only slide, widen the ranges of the swing joints or turn them at the start"
    )


def _worth(first: Sequence[Stand], second: Sequence[Stand]) -> Array:
    """Way sideways of a rectangle of two full swings, less for legs much turned."""
    one, other = (np.array([stand.pivot for stand in s]) for s in (first, second))
    turn, back = (np.array([s.yaw * s.swing for s in side]) for side in (first, second))
    bend, bent = (
        np.array([np.abs(stand.turns).max() for stand in s]) for s in (first, second)
    )
    apart = np.linalg.norm(one[:, None] - other, axis=-1)
    most: Array = np.maximum(bend[:, None], bent)
    return apart * turn[:, None] * back * np.exp(-most)


def _stands(
    limbs: Sequence[Limb], group: tuple[int, ...], weight: Array, ranges: Array
) -> Iterator[Stand]:
    every = np.array([limb.hip for limb in limbs])
    low, high = every.min(axis=0), every.max(axis=0)
    _, lengths, _ = _arms(limbs, group)
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, lengths.mean() / 2)
    places = np.linspace(-1, 1, PLACES) * half[:, None] + middle[:, None]
    for pivot in product(*places):
        if stand := _stand(limbs, group, weight, ranges, np.array(pivot)):
            yield stand


def _stand(
    limbs: Sequence[Limb],
    group: tuple[int, ...],
    weight: Array,
    ranges: Array,
    pivot: Array,
) -> Stand | None:
    """A group's legs turned towards a pivot; None where it could not stand or swing."""
    hips, lengths, bearing = _arms(limbs, group)
    away = hips - pivot
    distance = np.linalg.norm(away, axis=1)
    if distance.min() < 0.05 * lengths.min():
        return None
    turns = np.arctan2(*away.T[::-1]) - bearing
    turns = (turns + np.pi) % (2 * np.pi) - np.pi
    feet = hips + away / distance[:, None] * lengths[:, None]
    ratio = (distance + lengths) / lengths
    gains = ratio / ratio.max()
    clockwise, anticlockwise = ranges[list(group)].T
    room = np.minimum(anticlockwise - turns, turns - clockwise)
    swing = float((np.minimum(room, MOST_SWING) / gains).min())
    if swing <= LEAST_SWING or _surety(feet, weight) <= LEAST_LOAD:
        return None
    return Stand(group, pivot, turns, gains, 1 / float(ratio.max()), swing, feet)


def _arms(limbs: Sequence[Limb], group: tuple[int, ...]) -> tuple[Array, Array, Array]:
    """Hips (legs, 2), and lengths and bearings of the legs from there, (legs,)."""
    hips = np.array([limbs[i].hip for i in group])
    arms = np.array([limbs[i].toe[:2] for i in group]) - hips
    return hips, np.linalg.norm(arms, axis=1), np.arctan2(*arms.T[::-1])


def _in_step(
    limbs: Sequence[Limb], stand: Stand, weight: Array, ranges: Array
) -> Stand:
    """The stand, its pivot moved so that gains are halves, thirds or quarters.

    Servos with counts then have all its legs on counts together, where otherwise they
    push against each other. It stays as it is where no such pivot is near.
    """
    hips, lengths, _ = _arms(limbs, stand.legs)
    lead, pivot = int(stand.gains.argmax()), stand.pivot
    parts = np.arange(1, MOST_PARTS + 1)[:, None]
    choices = np.round(parts * stand.gains) / parts
    near = (np.abs(choices - stand.gains) < MOST_CHANGE) & (choices > 0)
    if not (fits := near.all(axis=1)).any():
        return stand
    wanted = choices[fits.argmax(), :, None]  # the coarsest
    for _ in range(NEWTON_STEPS):  # on ratio - wanted * ratio of the leading leg
        away = hips - pivot
        distance = np.linalg.norm(away, axis=1)[:, None]
        ratio, slope = (
            1 + distance / lengths[:, None],
            -away / distance / lengths[:, None],
        )
        off, turn = ratio - wanted * ratio[lead], slope - wanted * slope[lead]
        pivot = pivot - (np.linalg.pinv(turn) @ off)[:, 0]
    found = _stand(limbs, stand.legs, weight, ranges, pivot)
    in_step = found and np.abs(found.gains - wanted[:, 0]).max() < IN_STEP
    return found if in_step else stand


TRIED_ANGLES = 16  # angles that are tried, on each side
CLEARANCE = 1e-3  # [m] that parts keep from one another

Swings = Mapping[int, float]  # place of a limb -> its joint's angle per group's angle


class Reach(NamedTuple):
    """How far groups may swing either way."""

    swing: float  # [rad]
    reason: str  # what lies beyond, in words
    touching: bool  # whether it is another leg, and no joint's range


def free_reach(
    pose: Pose,
    limbs: Sequence[Limb],
    groups: Sequence[Swings],
    lift: float,
    source: str,
) -> Reach:
    """The largest swing at which nothing touches that does not where the robot stands.

    A lifted group is raised by an angle [rad]. Legs that cannot swing at all are
    refused.
    """
    rooms = {}
    for place, gain in chain.from_iterable(group.items() for group in groups):
        joint = limbs[place].swing
        (low, high), angle = pose.span(joint), pose.angle(joint)
        rooms[joint] = min(high - angle, angle - low) / abs(gain)
    joint = min(rooms, key=rooms.__getitem__)
    farthest = rooms[joint]
    if first := _Trial(pose, limbs, groups, lift).first_touching(farthest):
        level, (one, other) = first
        if level <= 1:
            raise ModelError(
                f"its legs cannot swing: {source}; {one!r} and {other!r} touch at "
                "once, make them smaller, or mount the legs farther apart"
            )
        swing = farthest * (level - 1) / TRIED_ANGLES
        return Reach(swing, f"beyond which {one!r} and {other!r} would touch", True)
    left = f"what is left of its range where {joint!r} stands"
    left += f", at {np.rad2deg(pose.angle(joint)) + 0.0:.0f} degrees"
    return Reach(farthest, f"which is {left}", False)


class _Trial:
    """Parts of a robot that touch at given angles of two groups."""

    def __init__(
        self, pose: Pose, limbs: Sequence[Limb], groups: Sequence[Swings], lift: float
    ) -> None:
        model = copy(pose.model)
        model.geom_margin[:] = CLEARANCE
        self._pose = Pose(model, mujoco.MjData(model), pose.root)
        self._pose.data.qpos[:] = pose.data.qpos
        self._rest = [(pose.angle(m.swing), pose.angle(m.lift)) for m in limbs]
        self._limbs, self._groups, self._lift = limbs, groups, lift
        self._always = set(self._pairs((0.0, 0.0), (False, False)))

    def first_touching(self, farthest: float) -> tuple[int, tuple[str, str]] | None:
        """The least level at which parts touch, and which; None up to the farthest."""
        sides = range(-TRIED_ANGLES, TRIED_ANGLES + 1)
        levels = sorted(product(sides, repeat=2), key=lambda at: max(map(abs, at)))
        name = self._pose.model.geom
        for one, other in levels:
            angles = farthest * one / TRIED_ANGLES, farthest * other / TRIED_ANGLES
            for raised in ((False, False), (True, False), (False, True)):
                for a, b in self._pairs(angles, raised):
                    if (a, b) not in self._always:
                        return max(abs(one), abs(other)), (name(a).name, name(b).name)
        return None

    def _pairs(
        self, swing: tuple[float, float], raised: tuple[bool, bool]
    ) -> Iterator[tuple[int, int]]:
        """Geoms of the robot that touch at angles of the groups [rad]."""
        angles = {}
        for group, angle, up in zip(self._groups, swing, raised, strict=True):
            for place, gain in group.items():
                limb = self._limbs[place]
                turned, lifted = self._rest[place]
                angles[limb.swing] = turned + gain * angle
                angles[limb.lift] = lifted + limb.up * self._lift * up
        self._pose.turn(angles)
        model, data = self._pose.model, self._pose.data
        mujoco.mj_collision(model, data)
        for contact in data.contact[: data.ncon]:
            one, other = sorted(int(geom) for geom in contact.geom)
            roots = model.body_rootid[model.geom_bodyid[[one, other]]]
            if (roots == self._pose.root).all() and not contact.exclude:
                yield one, other
