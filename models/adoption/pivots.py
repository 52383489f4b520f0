"""Groups of legs that can stand, and the posture in which each has a pivot.

All legs of a group move the body about one point without slip exactly where the legs,
produced inward, meet at that point: the group's pivot. Legs are turned until they do,
and legs farther from the pivot swing farther, in proportion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from models.adoption.anatomy import Limb
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
    count = len(limbs)

    def surety(group: tuple[int, ...]) -> float:
        loads = static_loads(feet[list(group)][None], weight[None])[0]
        balanced = np.abs(loads @ feet[list(group)] - weight).max() < 1e-6
        return float(loads.min()) if balanced else 0.0

    sure = []
    for size in range(2, count - 3):
        for group in combinations(range(1, count), size):
            one = (0, *group)
            other = tuple(i for i in range(count) if i not in one)
            if (least := min(surety(one), surety(other))) >= LEAST_LOAD:
                sure.append((least, one, other))
    if not sure:
        raise ModelError(
            f"no two groups of its {count} legs can stand alone in turn: {source}; its "
            "weight is not inside the feet of one while the others are lifted"
        )
    sure.sort(key=lambda way: -round(way[0], 6))
    return [(group, other) for _, group, other in sure[:MOST_WAYS]]


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
            after = feet.copy()
            for stand in (pair := (first[i], second[j])):
                after[list(stand.legs)] = stand.feet
            if pdist(after).min() > NEIGHBOUR_DISTANCE * pdist(feet).min():
                return pair
    raise ModelError(
        f"its legs cannot be turned so that they meet at pivots: {source}; each group "
        "can only slide, widen the ranges of the swing joints or turn them at the start"
    )


def _worth(first: Sequence[Stand], second: Sequence[Stand]) -> Array:
    """Way sideways of a rectangle of two full swings, less for legs much turned."""
    (one, turn, bend), (other, back, bent) = (
        (
            np.array([stand.pivot for stand in side]),
            np.array([stand.yaw * stand.swing for stand in side]),
            np.array([np.abs(stand.turns).max() for stand in side]),
        )
        for side in (first, second)
    )
    apart = np.linalg.norm(one[:, None] - other, axis=-1)
    most: Array = np.maximum(bend[:, None], bent)
    return apart * turn[:, None] * back * np.exp(-most)


def _stands(
    limbs: Sequence[Limb], group: tuple[int, ...], weight: Array, ranges: Array
) -> Iterator[Stand]:
    hips = np.array([limbs[i].hip for i in group])
    arms = np.array([limbs[i].toe[:2] for i in group]) - hips
    lengths = np.linalg.norm(arms, axis=1)
    bearing = np.arctan2(*arms.T[::-1])
    every = np.array([limb.hip for limb in limbs])
    low, high = every.min(axis=0), every.max(axis=0)
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, lengths.mean() / 2)
    places = np.linspace(-1, 1, PLACES) * half[:, None] + middle[:, None]
    for pivot in product(*places):
        away = hips - pivot
        distance = np.linalg.norm(away, axis=1)
        if distance.min() < 0.05 * lengths.min():
            continue
        turns = np.arctan2(*away.T[::-1]) - bearing
        turns = (turns + np.pi) % (2 * np.pi) - np.pi
        feet = hips + away / distance[:, None] * lengths[:, None]
        ratio = (distance + lengths) / lengths
        gains = ratio / ratio.max()
        clockwise, anticlockwise = ranges[list(group)].T
        room = np.minimum(anticlockwise - turns, turns - clockwise)
        swing = float((np.minimum(room, MOST_SWING) / gains).min())
        loads = static_loads(feet[None], weight[None])[0]
        balanced = np.abs(loads @ feet - weight).max() < 1e-6
        if swing > LEAST_SWING and balanced and loads.min() > LEAST_LOAD:
            yaw = 1 / float(ratio.max())
            yield Stand(group, np.array(pivot), turns, gains, yaw, swing, feet)
