"""Stability margin and clearance as expressions that a solver can differentiate.

The weight keeps a distance from every side of the support polygon. Which feet make the
sides is read off the robot with its legs at angle 0.

Two convex shapes that are apart are closest at a corner of one of them. Seen from
above, the distances of the robot's corners from the obstacles, and of the obstacles'
corners from the robot's sides, are therefore all that is needed. Their derivatives are
continuous outside of an obstacle. The least of them is smoothed, and is never
overestimated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from itertools import groupby, permutations

import numpy as np
import shapely

from models import Kinematics
from planner import Array
from planner.optimisation import Expression, Stage
from sim.obstacles.clearance import surroundings
from sim.optimisation.outlines import BODY, MovingPart, Place, discs, moving_parts
from sim.preparation.setup import Setup

FIRST_ANGLE = 3  # of the state, after the pose
SMOOTHED = 5e-4  # [m] within which the least of several distances is smoothed
TINY = 1e-12  # [m^2], keeps the root of a square differentiable
NEARBY_POINTS = 201  # of the path, to which obstacles may be near
ENDLESS = 10.0  # [m], of a corridor that counts as without end

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
        import casadi as ca

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
        import casadi as ca

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
    way = setup.scenario.path.curve.at(np.linspace(0.0, 1.0, NEARBY_POINTS))[:, :2]
    path, points = shapely.linestrings(way), shapely.points(way)
    for obstacle in setup.scenario.obstacles:
        for piece in obstacle.pieces:
            hull = shapely.orient_polygons(shapely.Polygon(piece.corners))
            corners = hull.exterior.coords[:-1]
            sides = [
                (begin, end)
                for begin, end in zip(corners, corners[1:] + corners[:1], strict=True)
                if shapely.distance(shapely.linestrings([begin, end]), path) < reach
                and (_outward(begin, end, shapely.get_coordinates(points).T) > 0).any()
            ]
            if sides:
                away = shapely.distance(shapely.points(corners), path)
                reached = [corners[k] for k in np.flatnonzero(away < reach)]
                yield Near(sides, reached)


def _distances(
    parts: Sequence[MovingPart],
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
    """Signed distance of a point from a convex polygon [m]; negative inside.

    Sides are in counter-clockwise order; some may be left out.
    """
    import casadi as ca

    out = beyond(point, sides)
    return ca.if_else(out > 0, apart(point, sides), out)


def beyond(point: Place, sides: Sides) -> Expression:
    """Signed distance of a point from the lines that sides are on [m], if convex."""
    import casadi as ca

    return reduce(ca.fmax, [_outward(*side, point) for side in sides])


def apart(point: Place, sides: Sides) -> Expression:
    """Distance of a point from the nearest of several segments [m]."""
    import casadi as ca

    nearest = reduce(ca.fmin, [_square(point, *side) for side in sides])
    return ca.sqrt(nearest + TINY)


def _square(point: Place, begin: Place, end: Place) -> Expression:
    """Squared distance of a point from a segment."""
    import casadi as ca

    along = end[0] - begin[0], end[1] - begin[1]
    out = point[0] - begin[0], point[1] - begin[1]
    share = (along[0] * out[0] + along[1] * out[1]) / (along[0] ** 2 + along[1] ** 2)
    share = ca.fmin(ca.fmax(share, 0.0), 1.0)
    return (out[0] - share * along[0]) ** 2 + (out[1] - share * along[1]) ** 2


def _outward(begin: Place, end: Place, point: Expression) -> Expression:
    """Distance of a point to the right of a line."""
    along = end[0] - begin[0], end[1] - begin[1]
    out = point[0] - begin[0], point[1] - begin[1]
    length = (along[0] ** 2 + along[1] ** 2) ** 0.5
    return (along[1] * out[0] - along[0] * out[1]) / length


def _soft_least(values: Sequence[Expression]) -> Expression:
    """A smooth lower bound on the least of several distances."""
    import casadi as ca

    least = reduce(ca.fmin, values)
    return least - SMOOTHED * ca.log(
        sum(ca.exp((least - v) / SMOOTHED) for v in values)
    )


def margins(
    setup: Setup, least: float
) -> Callable[[Stage, Sequence[Expression]], list[Expression]]:
    """Distance of the weight from each side of its support, less the least margin [m].

    The expressions, of a stage and a state's entries, must not be negative.
    """
    robot, kinematics = setup.robot, setup.kinematics
    foot, _, _, weight = kinematics.terms

    def of(stage: Stage, state: Sequence[Expression]) -> list[Expression]:
        planted = robot.planted(stage.stratum)
        raised = np.where(planted, 0.0, setup.limits.lift_angle) * robot.raise_sign
        feet, (x, y) = list[Place](), map(float, kinematics.center_of_mass[:2])
        for leg, group in enumerate(robot.group_of_leg):
            swing = state[FIRST_ANGLE + group] * float(robot.swing_gain[leg])
            feet.append(_sum(foot[leg], swing, float(raised[leg])))
            moved = _sum(weight[leg], swing, float(raised[leg]))
            x, y = x + moved[0], y + moved[1]
        return [
            -_outward(feet[i], feet[j], (x, y)) - least
            for i, j in _sides(kinematics, planted)
        ]

    return of


def _sides(kinematics: Kinematics, planted: Array) -> Iterator[tuple[int, int]]:
    """Pairs of feet that have all others on their left."""
    groups = len(kinematics.robot.groups)
    feet = kinematics.stance(np.zeros(groups)).feet
    standing = np.flatnonzero(planted)
    for i, j in permutations(standing.tolist(), 2):
        others = [k for k in standing if k not in (i, j)]
        if all(_outward(feet[i], feet[j], feet[k]) < 0 for k in others):
            yield i, j


def _sum(terms: Array, swing: Expression, lift: float) -> Place:
    """A leg's terms (3, 3, 3) at a swing to be solved for and a given lift."""
    import casadi as ca

    by_swing = np.einsum("abi,b->ai", terms, [1.0, np.cos(lift), np.sin(lift)])
    basis = (1.0, ca.cos(swing), ca.sin(swing))
    x, y = (sum(float(by_swing[a, i]) * basis[a] for a in range(3)) for i in range(2))
    return x, y
