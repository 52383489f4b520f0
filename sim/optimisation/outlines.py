"""A robot's solid parts seen from above, as functions of the angles of its legs.

Where the lift is given, the place of a leg's point is a sum of 1, cosine and sine of
the swing. Three samples therefore determine it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import mujoco
import numpy as np
import shapely

from models import Robot
from planner import Array
from planner.optimisation import Expression
from sim.obstacles.solids import Outline
from sim.preparation.setup import Setup

Place = tuple[Expression, Expression]
"""x, y in the body's frame [m], as numbers or as expressions."""

SWINGS = np.array([0.0, 0.4, -0.4])  # [rad] of a joint, where it is sampled
SAME_PLACE = 1e-7  # [m] between places that are taken for one
BODY = -1  # in place of a leg's index


@dataclass(frozen=True, eq=False)
class MovingPart:
    """A convex part, widened by a radius, that swings with one leg or with none."""

    leg: int  # `BODY` for what stays where it is in the body's frame
    terms: Array  # corners by 1, cosine and sine of the swing, (3, k, 2) [m]
    radius: float  # by which the hull of the corners is widened [m]

    def corners(self, cos: Expression = 1.0, sin: Expression = 0.0) -> list[Place]:
        """Corners in counter-clockwise order, at the cosine and sine of a swing."""
        one, by_cos, by_sin = self.terms.tolist()
        if self.leg == BODY:
            return [(a + c, b + d) for (a, b), (c, d) in zip(one, by_cos, strict=True)]
        return [
            (a + c * cos + e * sin, b + d * cos + f * sin)
            for (a, b), (c, d), (e, f) in zip(one, by_cos, by_sin, strict=True)
        ]

    @property
    def sampled(self) -> Array:
        """Corners at the sampled swings, shape (3, k, 2) [m]."""
        found: Array = np.einsum("sb,bki->ski", _BASIS, self.terms)
        return found


_BASIS = np.stack([np.ones(3), np.cos(SWINGS), np.sin(SWINGS)], axis=-1)


def moving_parts(setup: Setup, stratum: str) -> list[MovingPart]:
    """The parts that can collide, as they are on a stratum."""
    robot, outline = setup.robot, Outline(setup.robot, setup.model)
    raised = np.array([g not in stratum for g in robot.groups])
    lift = np.tile(raised * setup.limits.lift_angle, (len(SWINGS), 1))
    parts = list[MovingPart]()
    legs = [_leg_of(robot, setup.model, part.geom) for part in outline.solids.parts]
    for leg in sorted(set(legs)):
        gain = 1.0 if leg == BODY else float(robot.swing_gain[leg])
        swing = np.tile(SWINGS[:, None] / gain, (1, len(robot.groups)))
        qpos = outline.configurations(np.zeros((len(SWINGS), 3)), swing, lift)
        cores = outline.solids.cores(qpos)
        for part, core, own in zip(outline.solids.parts, cores, legs, strict=True):
            if own == leg:
                terms = np.einsum("bs,ski->bki", np.linalg.inv(_BASIS), core)
                parts.append(MovingPart(leg, terms[:, _hull(core[0])], part.radius))
    return parts


def discs(parts: list[MovingPart]) -> list[MovingPart]:
    """The corners of parts, one at a time, that make up their convex hull."""
    found = list[MovingPart]()
    for part in sorted(parts, key=lambda part: -part.radius):
        for k in range(part.terms.shape[1]):
            disc = MovingPart(part.leg, part.terms[:, k : k + 1], part.radius)
            if not any(_covers(other, disc) for other in found):
                found.append(disc)
    return [
        disc
        for disc in found
        if not any(_between(disc, *pair) for pair in combinations(found, 2))
    ]


def _covers(disc: MovingPart, other: MovingPart) -> bool:
    apart = np.linalg.norm(disc.sampled - other.sampled, axis=-1).max()
    return bool(apart + other.radius <= disc.radius + SAME_PLACE)


def _between(disc: MovingPart, one: MovingPart, other: MovingPart) -> bool:
    """Whether a disc lies within the hull of two others."""
    if disc in (one, other):
        return False
    begin, way = one.sampled, other.sampled - one.sampled
    squares = (way**2).sum(axis=-1)
    share = ((disc.sampled - begin) * way).sum(axis=-1) / squares
    off = np.linalg.norm(begin + share[..., None] * way - disc.sampled, axis=-1)
    radius = one.radius + share * (other.radius - one.radius)
    inside = (share >= 0) & (share <= 1) & (off + disc.radius <= radius + SAME_PLACE)
    return bool(inside.all())


def _hull(points: Array) -> list[int]:
    """Indices of the corners of a convex hull, counter-clockwise."""
    hull = shapely.convex_hull(shapely.multipoints(points))
    if hull.geom_type == "Polygon":
        hull = shapely.normalize(hull).exterior.reverse()
    corners = shapely.get_coordinates(hull)
    if len(corners) > 1 and np.allclose(corners[0], corners[-1]):
        corners = corners[:-1]
    apart = np.linalg.norm(points[None] - corners[:, None], axis=-1)
    nearest: list[int] = apart.argmin(axis=1).tolist()
    return nearest


def _leg_of(robot: Robot, model: mujoco.MjModel, geom: int) -> int:
    """Index of the leg that a geom is part of."""
    body, above = int(model.geom_bodyid[geom]), set[int]()
    while body:
        above.add(body)
        body = int(model.body_parentid[body])
    for leg, name in enumerate(robot.legs):
        card = robot.card.legs[name]
        joints = [model.joint(joint).id for joint in (card.swing, card.lift)]
        if above & {int(model.jnt_bodyid[joint]) for joint in joints}:
            return leg
    return BODY
