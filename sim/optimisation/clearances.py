"""Clearance as an expression that a solver can differentiate, for legs of any shape.

Two convex shapes that are apart are closest at a corner of one of them. The distances
of the robot's corners from the obstacles, and of their corners from its sides, are all
that is needed, seen from above. The least is smoothed, and never overestimated.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from itertools import combinations, groupby

import casadi as ca
import mujoco
import numpy as np
import shapely

from models import Robot
from models.description import joints_above
from planner import Array
from planner.optimisation import Expression, Stage
from sim.obstacles.clearance import Outline, surroundings
from sim.preparation.setup import Setup

FIRST_ANGLE = 3  # of the state, after the pose
SMOOTHED = 5e-4  # [m] within which the least of several distances is smoothed
TINY = 1e-12  # [m^2], keeps the root of a square differentiable
ENDLESS = 10.0  # [m], of a corridor that counts as without end
SWINGS = np.array([0.0, 0.4, -0.4])  # [rad] of a joint, where it is sampled
BASIS = np.stack([np.ones(3), np.cos(SWINGS), np.sin(SWINGS)], axis=-1)
SAME_PLACE = 1e-7  # [m] between places that are taken for one
BODY = -1  # in place of a leg's index

Place = tuple[Expression, Expression]  # x, y in the body's frame [m]
Sides = Sequence[tuple[Place, Place]]


@dataclass(frozen=True)
class Near:
    """What a robot on its way can come near to of one convex piece of an obstacle."""

    sides: Sides
    corners: Sequence[Place]


def clearances(
    setup: Setup, least: float, within: float
) -> Callable[[Stage, Sequence[Expression]], list[Expression]]:
    """Clearance of body and legs from all obstacles, less the least one asked for [m].

    The body deviates from its path by at most `within` [m]. The expressions, of a stage
    and a state's entries, must not be negative.
    """
    pieces = list(near_pieces(setup, within))
    size = FIRST_ANGLE + len(setup.robot.groups)

    @lru_cache
    def least_distances(stratum: str) -> Expression:
        state, rows = ca.SX.sym("state", size), list[Expression]()
        pose = state[0], state[1], ca.cos(state[2]), ca.sin(state[2])
        for leg, own in groupby(moving_parts(setup, stratum), lambda part: part.leg):
            gain = float(setup.robot.swing_gain[leg])
            group = FIRST_ANGLE + setup.robot.group_of_leg[leg]
            swing = 0.0 if leg == BODY else gain * state[group]
            angle = ca.cos(swing), ca.sin(swing)
            found = list(_distances(list(own), angle, pose, pieces))
            rows += [_soft_least(found)] if found else []
        return ca.Function("clearances", [state], [ca.vertcat(*rows)])

    def of(stage: Stage, state: Sequence[Expression]) -> list[Expression]:
        found = least_distances(stage.stratum)(ca.vertcat(*state[:size]))
        return [found[i] - least for i in range(found.shape[0])]

    return of


def near_pieces(setup: Setup, within: float) -> Iterator[Near]:
    """Sides and corners of obstacles within reach of a body so near to its path [m]."""
    outline = surroundings(setup).outline
    swings = [limits for limits in zip(*setup.equations.limits.values(), strict=True)]
    angles = np.array([*swings, np.zeros(len(setup.robot.groups))])
    still = np.zeros((len(angles), 3)), angles, np.zeros_like(angles)
    reach = max(map(outline.radius, outline.configurations(*still)))
    reach += min(within, ENDLESS) + setup.scenario.min_clearance
    way = setup.scenario.path.curve.at(np.linspace(0.0, 1.0, 201))[:, :2]
    path, points = shapely.linestrings(way), shapely.points(way)
    for obstacle in setup.scenario.obstacles:
        for piece in obstacle.pieces:
            hull = shapely.orient_polygons(shapely.Polygon(piece.corners))
            corners = hull.exterior.coords[:-1]
            sides = [
                (begin, end)
                for begin, end in zip(corners, corners[1:] + corners[:1], strict=True)
                if shapely.distance(shapely.linestrings([begin, end]), path) < reach
                and (outward(begin, end, shapely.get_coordinates(points).T) > 0).any()
            ]
            if sides:
                away = shapely.distance(shapely.points(corners), path)
                yield Near(sides, [corners[k] for k in np.flatnonzero(away < reach)])


def _distances(
    parts: "Sequence[MovingPart]",
    angle: Place,
    pose: tuple[Expression, Expression, Expression, Expression],
    pieces: Sequence[Near],
) -> Iterator[Expression]:
    """Distances between parts of one leg, or the body, and pieces of obstacles."""
    x, y, cos, sin = pose
    for disc in discs(list(parts)):
        ((u, v),) = disc.corners(*angle)
        place = x + cos * u - sin * v, y + sin * u + cos * v
        for piece in pieces:
            away = distance if piece.corners else beyond  # no end of a side in reach
            yield away(place, piece.sides) - disc.radius
    for part in parts:
        own = part.corners(*angle)
        if len(own) < 2:
            continue
        sides = list(zip(own, own[1:] + own[:1], strict=True))
        for corner in (corner for piece in pieces for corner in piece.corners):
            u, v = corner[0] - x, corner[1] - y
            local = cos * u + sin * v, cos * v - sin * u
            found = distance(local, sides) if len(own) > 2 else apart(local, sides[:1])
            yield found - part.radius


def distance(point: Place, sides: Sides) -> Expression:
    """Signed distance of a point from a convex polygon, some sides left out [m]."""
    out = beyond(point, sides)
    return ca.if_else(out > 0, apart(point, sides), out)


def beyond(point: Place, sides: Sides) -> Expression:
    """Signed distance of a point from the lines that sides are on [m], if convex."""
    return reduce(ca.fmax, [outward(*side, point) for side in sides])


def apart(point: Place, sides: Sides) -> Expression:
    """Distance of a point from the nearest of several segments [m]."""
    return ca.sqrt(reduce(ca.fmin, [_square(point, *side) for side in sides]) + TINY)


def _square(point: Place, begin: Place, end: Place) -> Expression:
    """Squared distance of a point from a segment."""
    along = end[0] - begin[0], end[1] - begin[1]
    out = point[0] - begin[0], point[1] - begin[1]
    share = (along[0] * out[0] + along[1] * out[1]) / (along[0] ** 2 + along[1] ** 2)
    share = ca.fmin(ca.fmax(share, 0.0), 1.0)
    return (out[0] - share * along[0]) ** 2 + (out[1] - share * along[1]) ** 2


def outward(begin: Place, end: Place, point: Expression) -> Expression:
    """Distance of a point to the right of a line."""
    along = end[0] - begin[0], end[1] - begin[1]
    out = point[0] - begin[0], point[1] - begin[1]
    length = (along[0] ** 2 + along[1] ** 2) ** 0.5
    return (along[1] * out[0] - along[0] * out[1]) / length


def place_of(terms: Array, swing: Expression, lift: float) -> Place:
    """A leg's point of terms (3, 3, 3) at a swing to be solved for and a given lift."""
    by_swing = np.einsum("abi,b->ai", terms, [1.0, np.cos(lift), np.sin(lift)])
    basis = (1.0, ca.cos(swing), ca.sin(swing))
    x, y = (sum(float(by_swing[a, i]) * basis[a] for a in range(3)) for i in range(2))
    return x, y


def _soft_least(values: Sequence[Expression]) -> Expression:
    """A smooth lower bound on the least of several distances."""
    low = reduce(ca.fmin, values)
    return low - SMOOTHED * ca.log(sum(ca.exp((low - v) / SMOOTHED) for v in values))


@dataclass(frozen=True, eq=False)
class MovingPart:
    """A convex part, widened by a radius, that swings with one leg or with none.

    The place of a leg's point is a sum of 1, cosine and sine of the swing, which three
    samples determine.
    """

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
        return np.einsum("sb,bki->ski", BASIS, self.terms)


def moving_parts(setup: Setup, stratum: str) -> list[MovingPart]:
    """The parts that can collide, as they are on a stratum."""
    robot, outline = setup.robot, Outline(setup.robot, setup.model)
    raised = np.array([group not in stratum for group in robot.groups])
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
                terms = np.einsum("bs,ski->bki", np.linalg.inv(BASIS), core)
                parts.append(MovingPart(leg, terms[:, hull_of(core[0])], part.radius))
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
    share = ((disc.sampled - begin) * way).sum(axis=-1) / (way**2).sum(axis=-1)
    off = np.linalg.norm(begin + share[..., None] * way - disc.sampled, axis=-1)
    radius = one.radius + share * (other.radius - one.radius)
    inside = (share >= 0) & (share <= 1) & (off + disc.radius <= radius + SAME_PLACE)
    return bool(inside.all())


def hull_of(points: Array) -> list[int]:
    """Indices of the corners of a convex hull, counter-clockwise."""
    hull = shapely.convex_hull(shapely.multipoints(points))
    if hull.geom_type == "Polygon":
        hull = shapely.normalize(hull).exterior.reverse()
    corners = shapely.get_coordinates(hull)
    if len(corners) > 1 and np.allclose(corners[0], corners[-1]):
        corners = corners[:-1]
    apart = np.linalg.norm(points[None] - corners[:, None], axis=-1)
    return apart.argmin(axis=1).tolist()


def _leg_of(robot: Robot, model: mujoco.MjModel, geom: int) -> int:
    """Index of the leg that a geom is part of."""
    above = joints_above(model, int(model.geom_bodyid[geom]))
    for leg, card in enumerate(robot.leg_cards):
        if any(model.joint(name).id in above for name in (card.swing, card.lift)):
            return leg
    return BODY
