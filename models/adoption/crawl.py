"""A crawl: the legs row on the ground, then each is set back while the others stand.

It is for robots of which no two groups of legs can stand alone, such as most on four
legs. With a leg in the air the weight must lie inside the feet of the others: legs are
turned at the start, to the posture in which they row farthest and can yet be set back.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from models.adoption.anatomy import Limb, Pose
from models.adoption.groups import LEAST_LOAD, MOST_SWING
from models.adoption.words import refusal
from models.contact.dissipation import least_dissipation_twist
from models.contact.loads import least_load, static_loads
from planner import Array
from planner.execution import reposition_legs

FEWEST_LEGS, MOST_LEGS = 4, 6  # legs of robots for which crawls are searched for
PLACES = 9  # of the feet, along each axis
SHARES = (1.0, 0.75, 0.5, 0.35, 0.25, 0.15)  # of the longest stroke
PUSHED = 0.3  # of the way that the fastest foot would push the body without slip
TINY = 1e-12  # in the place of a zero to divide by
IDLE = 0.05  # of the fastest leg's swing: legs slower than that are left out


@dataclass(frozen=True, eq=False)
class Crawl:
    """Legs turned such that they can row."""

    turns: Array  # how far each leg is turned from how it stands, anticlockwise [rad]
    # anticlockwise swing of each leg that pushes the body ahead, at most 1
    forward: Array
    turning: Array  # the same for a turn of the body to the left
    stroke: float  # how far the fastest leg can swing either way [rad]
    skewed: bool  # whether the posture is not the same left and right

    @property
    def worth(self) -> float:
        """Its stroke, less for legs much turned, and for left and right unlike."""
        bent = float(np.abs(self.turns).max())
        return self.stroke * np.exp(-bent) * (0.7 if self.skewed else 1.0)


@dataclass(frozen=True, eq=False)
class _Body:
    """Hips, legs and weight from above, the legs where they stand."""

    hips: Array  # (L, 2)
    arms: Array  # from hip to foot, (L, 2)
    weight: Array  # (2,)
    shares: Array  # of the weight, that is each leg's, (L,)
    leans: Array  # from hip to the leg's centre of mass, (L, 2)

    @classmethod
    def of(cls, pose: Pose, limbs: Sequence[Limb]) -> "_Body":
        model, mass = pose.model, pose.model.body_subtreemass
        bodies = [int(model.joint(limb.swing).bodyid[0]) for limb in limbs]
        hips = np.array([limb.hip for limb in limbs])
        arms = np.array([limb.toe[:2] for limb in limbs]) - hips
        leans = pose.data.subtree_com[bodies][:, :2] - hips
        shares = mass[bodies] / mass[pose.root]
        return cls(hips, arms, pose.center_of_mass[:2], shares, leans)

    def placed(self, turns: Array) -> tuple[Array, Array]:
        """Feet (..., L, 2) and weight (..., 2) with every leg turned, (..., L)."""
        moved = _turned(self.leans, turns) - self.leans
        weight = self.weight + (self.shares[:, None] * moved).sum(axis=-2)
        return self.hips + _turned(self.arms, turns), weight

    def sweeps(self, turns: Array) -> Array:
        """Velocity of each foot for an anticlockwise swing, (L, 2) [m/rad]."""
        arms = _turned(self.arms, turns)
        return np.stack([-arms[:, 1], arms[:, 0]], axis=1)

    def patterns(self, turns: Array) -> tuple[Array, Array]:
        """Swings, ahead and around, that move feet as if the body moved as wished."""
        sweeps = self.sweeps(turns)
        feet, weight = self.placed(turns)
        spokes = feet - weight
        back = np.broadcast_to((-1.0, 0.0), spokes.shape)
        around = np.stack([spokes[:, 1], -spokes[:, 0]], axis=1)
        swings = []
        for way in (back, around):
            rate = (sweeps * way).sum(axis=1) / (sweeps**2).sum(axis=1)
            gains = rate / max(float(np.abs(rate).max()), TINY)
            swings.append(np.where(np.abs(gains) < IDLE, 0.0, gains))
        return swings[0], swings[1]


def _turned(arms: Array, angles: Array) -> Array:
    x, y = arms.T
    c, s = np.cos(angles), np.sin(angles)
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def find_crawl(pose: Pose, limbs: Sequence[Limb], ranges: Array, source: str) -> Crawl:
    """The posture in which the legs can row farthest, refused if there is none.

    Ranges say how far each leg may turn clockwise and anticlockwise from how it stands,
    shape (legs, 2) [rad].
    """
    if not FEWEST_LEGS <= len(limbs) <= MOST_LEGS:
        drafted = {"fewest": FEWEST_LEGS, "most": MOST_LEGS}
        raise refusal("no_crawl", source, count=len(limbs), **drafted)
    body = _Body.of(pose, limbs)
    every = product(_postures(body, ranges), SHARES)
    tries = [replace(crawl, stroke=share * crawl.stroke) for crawl, share in every]
    worthy = (crawl for crawl in tries if crawl.stroke > 0.04)  # [rad]
    for crawl in sorted(worthy, key=lambda crawl: -crawl.worth):
        ways = product((crawl.forward, crawl.turning), (-1, 1))
        ends = [side * crawl.stroke * gains for gains, side in ways]
        if _pushes(body, crawl) and all(_moves(body, crawl, e, ranges) for e in ends):
            return crawl
    raise refusal("no_rowing", source, least=LEAST_LOAD)


def _postures(body: _Body, ranges: Array) -> Iterator[Crawl]:
    """All feet shifted one way, as far as legs can, and all legs turned alike."""
    sweeps = body.sweeps(np.zeros(len(ranges)))
    lengths = (sweeps**2).sum(axis=1)
    shifts = np.linspace(-1, 1, PLACES) * float(np.sqrt(lengths).max())
    for x, y, spin in product(shifts, shifts, (0.0, -0.4, 0.4, -0.8, 0.8)):  # [rad]
        turns = sweeps @ (x, y) / lengths + spin
        room = np.minimum(ranges[:, 1] - turns, turns - ranges[:, 0])
        if (room < 0).any():
            continue
        forward, turning = body.patterns(turns)
        used = np.maximum(np.abs(forward), np.abs(turning))
        stroke = float((np.minimum(room, MOST_SWING) / np.maximum(used, TINY)).min())
        yield Crawl(turns, forward, turning, stroke, skewed=bool(y or spin))


def _pushes(body: _Body, crawl: Crawl) -> bool:
    """Whether the body goes ahead and around, although some feet slide."""
    sweeps = body.sweeps(crawl.turns)
    feet, weight = body.placed(crawl.turns)
    loads = static_loads(feet[None], weight[None])
    arm = float(np.linalg.norm(feet - weight, axis=1).mean())
    for gains, unit in ((crawl.forward, (1, 0, 0)), (crawl.turning, (0, 0, arm))):
        rates = sweeps * gains[:, None]
        twist = least_dissipation_twist(feet[None], rates[None], loads)[0]
        if twist @ unit <= PUSHED * np.linalg.norm(rates, axis=1).max():
            return False
    return True


def _moves(body: _Body, crawl: Crawl, ends: Array, ranges: Array) -> bool:
    """Whether legs can be brought from rest to the ends of a stroke one at a time."""
    every = zip(crawl.turns, ends, ranges, strict=True)
    places = [np.unique(np.round([0, end, *(s - turn)], 9)) for turn, end, s in every]
    grid = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1)
    feet, weight = body.placed(crawl.turns + grid)
    others = [np.arange(len(ends)) != leg for leg in range(len(ends))]
    loads = [least_load(feet[..., on, :], weight) for on in others]
    now = [int(np.abs(place).argmin()) for place in places]
    goal = [int(np.abs(p - end).argmin()) for p, end in zip(places, ends, strict=True)]
    return reposition_legs(places, np.stack(loads) >= LEAST_LOAD, now, goal) is not None
