"""Groups of legs that can stand, the posture in which each has a pivot, and its swings.

All legs of a group move the body about one point without slip exactly where the legs,
produced inward, meet at that point: the group's pivot. Legs are turned until they do,
and legs farther from the pivot swing farther, in proportion, and in ratios of small
whole numbers where a pivot nearby allows it. How far groups swing before their parts
touch is found on a grid of both angles, on the ground and lifted.
"""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from itertools import chain, combinations, product
from typing import NamedTuple

import mujoco
import numpy as np

from models.adoption.anatomy import Limb, Pose
from models.adoption.words import refusal
from models.contact.loads import static_loads
from planner import Array
from planner.support import tick

PLACES = 25  # along each side of the field in which pivots are looked for
MOST_SWING = 0.45  # [rad] either way, of the leg that swings farthest
LEAST_SWING = 0.1  # [rad] either way, of a group
LEAST_LOAD = 0.06  # share of the weight on each foot of a group that stands
MOST_WAYS = 12  # pairs of groups that are tried
MOST_PAIRS = 200  # pairs of pivots of each
MOST_PARTS = 4  # into which the gain of the leg that swings farthest is divided
MOST_CHANGE = 0.1  # of a gain, for which a pivot is moved
NEWTON_STEPS, IN_STEP = 8, 1e-9  # and how near to what is wanted gains then are

Groups = tuple[tuple[int, ...], tuple[int, ...]]


@dataclass(frozen=True, eq=False)
class Stand:
    """A group's legs turned towards a pivot."""

    legs: tuple[int, ...]  # their places among the limbs
    pivot: Array  # where their lines meet, shape (2,) [m]
    turns: Array  # how far each leg is turned from how it stands, anticlockwise [rad]
    gains: Array  # swing of each leg per angle of the group, at most 1
    yaw: float  # turn of the body per radian of the group
    swing: float  # how far the group swings either way [rad]
    feet: Array  # where the feet are then, shape (legs, 2) [m]
    load: float  # least share of the weight on one; on uneven loads the body leans


def two_groups(limbs: Sequence[Limb], weight: Array, source: str) -> list[Groups]:
    """Ways to make two groups of legs that each stand alone, the surest first."""
    feet = np.array([limb.toe[:2] for limb in limbs])
    count, sure = len(limbs), []
    for size in range(2, count - 3):
        for group in combinations(range(1, count), size):
            tick()
            one = (0, *group)
            other = tuple(i for i in range(count) if i not in one)
            least = min(_surety(feet[list(g)], weight) for g in (one, other))
            if least >= LEAST_LOAD:
                sure.append((least, one, other))
    if not sure:
        raise refusal("no_groups", source, count=count)
    sure.sort(key=lambda way: -round(way[0], 6))
    return [(group, other) for _, group, other in sure[:MOST_WAYS]]


def _surety(feet: Array, weight: Array) -> float:
    """Least share of the weight on any of some feet; 0 where they do not balance it."""
    loads = static_loads(feet[None], weight[None])[0]
    return float(loads.min()) if np.abs(loads @ feet - weight).max() < 1e-6 else 0.0


def posed(
    limbs: Sequence[Limb], ways: Sequence[Groups], weight: Array, room: Array, file: str
) -> tuple[Stand, Stand]:
    """The pair of pivots from which the robot goes farthest sideways.

    Room is how far each leg may turn clockwise and anticlockwise from how it stands,
    shape (legs, 2) [rad]. Turned legs keep apart as before, as found and once moved.
    """
    from scipy.spatial.distance import pdist  # slow to import, and seldom needed

    feet = np.array([limb.toe[:2] for limb in limbs])
    hips = np.array([limb.hip for limb in limbs])
    least = 0.6 * pdist(feet).min()  # that turned legs keep
    for groups in ways:
        sides = [
            _Legs(g, hips[[*g]], (feet - hips)[[*g]], room[[*g]], weight)
            for g in groups
        ]
        first, second = (list(side.stands(hips)) for side in sides)
        if not first or not second:
            continue
        worth = _worth(first, second)
        order = np.argsort(-(worth / worth.max()).round(9), axis=None, kind="stable")
        for place in order[:MOST_PAIRS]:  # of equals the first, on every processor
            i, j = np.unravel_index(place, worth.shape)
            found = first[i], second[j]
            moved = sides[0].in_step(found[0]), sides[1].in_step(found[1])
            gap, left = (np.linalg.norm(a.pivot - b.pivot) for a, b in (found, moved))
            moved = moved if left > gap / 2 else found  # or it cannot go sideways
            after = [np.concatenate([a.feet, b.feet]) for a, b in (found, moved)]
            if min(pdist(places).min() for places in after) > least:
                return moved
    raise refusal("no_pivots", file)


def _worth(first: Sequence[Stand], second: Sequence[Stand]) -> Array:
    """Way sideways of two full swings, less for legs much turned and uneven loads."""
    one, other = (np.array([stand.pivot for stand in s]) for s in (first, second))
    turn, back = ([s.yaw * s.swing * s.load for s in side] for side in (first, second))
    bends = ([np.abs(stand.turns).max() for stand in s] for s in (first, second))
    apart = np.linalg.norm(one[:, None] - other, axis=-1)
    return apart * np.outer(turn, back) * np.exp(-np.maximum.outer(*bends))


class _Legs(NamedTuple):
    """Legs of a group as they stand, what they may turn, and the weight above them."""

    places: tuple[int, ...]  # among the limbs
    hips: Array
    arms: Array  # from hip to foot
    ranges: Array
    weight: Array

    def stands(self, hips: Array) -> Iterator[Stand]:
        """The legs turned to pivots all over the field of the hips."""
        lengths = np.linalg.norm(self.arms, axis=1)
        low, high = hips.min(axis=0), hips.max(axis=0)
        half = np.maximum((high - low) / 2, lengths.mean() / 2)[:, None]
        fields = np.linspace(-1, 1, PLACES) * half + ((low + high) / 2)[:, None]
        return filter(None, (self.turned(np.array(p)) for p in product(*fields)))

    def turned(self, pivot: Array) -> Stand | None:
        """The legs turned to a pivot; None where they could not stand or swing."""
        away, lengths = self.hips - pivot, np.linalg.norm(self.arms, axis=1)
        distance = np.linalg.norm(away, axis=1)
        if distance.min() < 0.05 * lengths.min():
            return None
        turns = np.arctan2(*away.T[::-1]) - np.arctan2(*self.arms.T[::-1])
        turns = (turns + np.pi) % (2 * np.pi) - np.pi
        feet = self.hips + away / distance[:, None] * lengths[:, None]
        ratio = (distance + lengths) / lengths
        gains = ratio / ratio.max()
        clockwise, anticlockwise = self.ranges.T
        room = np.minimum(anticlockwise - turns, turns - clockwise)
        swing = float((np.minimum(room, MOST_SWING) / gains).min())
        if swing <= LEAST_SWING or (load := _surety(feet, self.weight)) <= LEAST_LOAD:
            return None
        yaw = 1 / float(ratio.max())
        return Stand(self.places, pivot, turns, gains, yaw, swing, feet, load)

    def in_step(self, stand: Stand) -> Stand:
        """A stand, its pivot moved so that gains are halves, thirds or quarters.

        Servos with counts then have all legs on counts together, where otherwise they
        push against each other. It stays as it is where no such pivot is near.
        """
        parts = np.arange(1, MOST_PARTS + 1)[:, None]
        choices = np.round(parts * stand.gains) / parts
        near = (np.abs(choices - stand.gains) < MOST_CHANGE) & (choices > 0)
        if not (fits := near.all(axis=1)).any():
            return stand
        wanted, lead = choices[fits.argmax(), :, None], stand.gains.round(9).argmax()
        pivot, lengths = stand.pivot, np.linalg.norm(self.arms, axis=1)[:, None]
        for _ in range(NEWTON_STEPS):  # on ratio - wanted * ratio of the leading leg
            away = self.hips - pivot
            distance = np.linalg.norm(away, axis=1)[:, None]
            ratio, slope = 1 + distance / lengths, -away / distance / lengths
            off, rise = ratio - wanted * ratio[lead], slope - wanted * slope[lead]
            pivot = pivot - (np.linalg.pinv(rise) @ off)[:, 0]
        found = self.turned(pivot)
        met = found and np.abs(found.gains - wanted[:, 0]).max() < IN_STEP
        return found if found and met else stand


TRIED_ANGLES = 16  # angles that are tried, on each side
CLEARANCE = 1e-3  # [m] that parts keep from one another, or
NARROW = 0.01  # of the farthest that a foot reaches out, where that is less
FLUSH = 1e-5  # [m] to which distances are known

Swings = Mapping[int, float]  # place of a limb -> its joint's angle per group's angle


class Reach(NamedTuple):
    """How far groups may swing either way."""

    swing: float  # [rad]
    reason: str  # what lies beyond, in words
    touching: bool  # whether it is another leg, and no joint's range


def free_reach(
    pose: Pose, limbs: Sequence[Limb], groups: Sequence[Swings], lift: float, file: str
) -> Reach:
    """The largest swing at which nothing touches that does not where the robot stands.

    A lifted group is raised by an angle [rad]; legs that cannot swing are refused.
    """
    rooms = {}
    for place, gain in chain.from_iterable(group.items() for group in groups):
        joint = limbs[place].swing
        (low, high), angle = pose.span(joint), pose.angle(joint)
        rooms[joint] = min(high - angle, angle - low, np.pi / 2) / abs(gain)
    joint = min(rooms, key=lambda name: round(rooms[name], 9))  # of equals the first
    farthest = rooms[joint]
    if first := _Trial(pose, limbs, groups, lift).first_touching(farthest):
        level, (one, other) = first
        if level <= 1:
            raise refusal("touching", file, one=one, other=other)
        swing = farthest * (level - 1) / TRIED_ANGLES
        return Reach(swing, f"beyond which {one!r} and {other!r} would touch", True)
    left = f"where {joint!r} is the first joint to reach an end of its range"
    if angle := round(pose.angle(joint), 2):
        left += f"; at the start it stands at {angle:.2f} rad"
    return Reach(farthest, left, False)


class _Trial:
    """Parts of a robot that touch at given angles of two groups."""

    def __init__(
        self, pose: Pose, limbs: Sequence[Limb], groups: Sequence[Swings], lift: float
    ) -> None:
        model = copy(pose.model)
        reach = max(float(np.hypot(*(limb.toe[:2] - limb.hip))) for limb in limbs)
        model.geom_margin[:] = min(CLEARANCE, NARROW * reach)
        self._pose = Pose(model, mujoco.MjData(model), pose.root)
        self._pose.data.qpos[:] = pose.data.qpos
        self._rest = [(pose.angle(m.swing), pose.angle(m.lift)) for m in limbs]
        self._limbs, self._groups, self._lift = limbs, groups, lift
        self._at_rest = self._near((0.0, 0.0), (False, False))

    def first_touching(self, farthest: float) -> tuple[int, tuple[str, str]] | None:
        """The least level at which parts touch, and which; None up to the farthest."""
        sides = range(-TRIED_ANGLES, TRIED_ANGLES + 1)
        levels = sorted(product(sides, repeat=2), key=lambda at: max(map(abs, at)))
        name = self._pose.model.geom
        for one, other in levels:
            angles = farthest * one / TRIED_ANGLES, farthest * other / TRIED_ANGLES
            for raised in ((False, False), (True, False), (False, True)):
                for (a, b), apart in self._near(angles, raised).items():
                    before = self._at_rest.get((a, b))
                    if before is None or apart < -FLUSH and before >= 0:
                        return max(abs(one), abs(other)), (name(a).name, name(b).name)
        return None

    def _near(
        self, swing: tuple[float, float], raised: tuple[bool, bool]
    ) -> dict[tuple[int, int], float]:
        """Distances of geoms of the robot that are near at angles of the groups [m]."""
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
        geoms = data.contact.geom.reshape(-1, 2)
        roots = model.body_rootid[model.geom_bodyid[geoms]]
        own = (roots == self._pose.root).all(axis=1) & (data.contact.exclude == 0)
        order = np.argsort(-data.contact.dist[own])  # of a pair's contacts the deepest
        pairs = map(tuple, np.sort(geoms[own])[order].tolist())
        return dict(zip(pairs, data.contact.dist[own][order].tolist(), strict=True))
