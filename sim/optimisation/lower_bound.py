r"""A time that every walk along a path takes at least, with the proof.

A walk visits strata: some groups are lifted, another strokes, the lifted ones recover,
and they land again. On a visit the body moves to and fro along one curve, since it
depends on the angle phi of the group that strokes alone. Let G(phi) and Y(phi) be place
and heading on this curve, zero at phi = 0, and alpha the heading at phi = 0. A visit
from angle a to angle b moves the body by R(alpha) (G(b) - G(a)), with headings
alpha + Y on the way. It takes at least T(|b - a|) for lifting, one stroke and landing.

Take any vector lambda, and a function V of each group's angle whose slope is at most
the time that a recovery takes per radian. If all alpha, a and b with headings within
the tolerance satisfy

    lambda . R(alpha) (G(b) - G(a)) + V(b) - V(a) <= rho T(|b - a|),    rho >= 1,    (*)

then lambda . x + V_1(phi_1) + V_2(phi_2) + ... grows by at most rho times the duration
of a visit, recoveries included. Legs end where they began, so V cancels, and the walk
takes at least lambda . (goal - start) / rho. The best lambda and V for some alpha, a, b
solve a linear program. Then rho is found for all of them, and the bound holds even if
the program was solved badly: on the cells of a grid the left side of (*) is at most its
largest value at corners plus the error of linear interpolation, spacing^2 / 8 times the
second derivatives; T is concave, so that it is at least its least at corners.

A path that turns is cut in K pieces with a lambda each. The walk passes the cuts within
the tolerance, which costs |lambda| times it on either side. A visit under way at a cut
counts as two; together they take no more than it does, plus a visit without a stroke
and what a stroke loses by accelerating. Where recoveries overlap strokes a visit takes
at least any weighted mean of both, and the program chooses the weights. Where strokes
depend on more, or take place with all feet down, this proves nothing. What remains is
the way at the highest speed: a walk is at least as long as the way through circles
around the points of the path, and the fastest stroke is nowhere outrun.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, pi

import numpy as np

from planner import Array
from sim.optimisation.formulation import ROUGH, task_of
from sim.optimisation.judging import real_twists
from sim.optimisation.visits import ANGLES, Curve, curves, headings_at, visits
from sim.preparation.setup import Setup

PIECES = (1, 2, 3, 4)  # numbers of them that are tried
EVERY = 4  # of these, in the linear program
FEW_HEADINGS = 64  # in the linear program
DIRECTIONS = 32  # in which the length of a vector is compared
SWEPT_ANGLES = 25  # of each group, ends of the joint range included
DRAWN_ANGLES = 4000  # where there are too many groups for a grid
MOST_GRIDDED = 2  # groups
BOUND_POINTS = 101  # of the path


def least_time(setup: Setup, within: float, yaw: float = inf) -> float:
    """Time that any walk along the path takes at least [s], without holds.

    Args:
        setup: Robot, path and speeds.
        within: How far the body may stray from the path [m].
        yaw: How far it may turn from the path's yaw [rad].

    Example:
        >>> from sim import least_time, load_scenario, prepare
        >>> setup = prepare(load_scenario("line"))
        >>> least_time(setup, within=0.02, yaw=0.17) > 50  # [s]
        True
    """
    points = setup.scenario.path.curve.at(np.linspace(0.0, 1.0, BOUND_POINTS))
    plain = shortest_way(points[:, :2], within) / top_speed(setup)
    found = list(curves(setup, task_of(setup, (within, yaw))))
    known = [curve for curve in found if curve is not None]
    if not known or None in found:
        return plain
    proven = (_proven(setup, known, points, within, yaw, k) for k in PIECES)
    return float(max(plain, *proven))


def _proven(
    setup: Setup,
    groups: Sequence[Curve],
    points: Array,
    within: float,
    yaw: float,
    count: int,
) -> float:
    """The bound by a path in so many pieces, 0 at least."""
    cuts = np.linspace(0, len(points) - 1, count + 1).round().astype(int)
    spans = [
        (float(part[:, 2].min() - yaw), float(part[:, 2].max() + yaw))
        for part in (points[a : b + 1] for a, b in pairwise(cuts))
    ]
    ways = np.diff(points[cuts, :2], axis=0)
    radii = np.full(count + 1, within)
    radii[[0, -1]] = 0.0
    loose = radii[1:] + radii[:-1]
    overlapped = setup.scenario.overlap_recovery
    found = _certificate(groups, spans, ways, loose, overlapped)
    if found is None:
        return 0.0
    leads, heights, share = found
    rates = [
        _largest_rate(curve, span, lead, height, 1.0 - share)
        for span, lead in zip(spans, leads, strict=True)
        for curve, height in zip(groups, heights, strict=True)
    ]
    gained = float((leads * ways).sum() - np.linalg.norm(leads, axis=1) @ loose)
    lost = (count - 1) * max(curve.times[0] + curve.spare for curve in groups)
    return max(0.0, gained / max(1.0, *rates) - lost)


def _certificate(
    groups: Sequence[Curve],
    spans: Sequence[tuple[float, float]],
    ways: Array,
    loose: Array,
    overlapped: bool,
) -> tuple[Array, Array, float] | None:
    """The best lambda of each piece, V of each group and weight of recoveries.

    The shapes are (K, 2) and (groups, angles). They satisfy the condition on a part of
    the grid only.
    """
    count, knots = len(spans), np.arange(0, ANGLES, EVERY)
    size = 3 * count + len(groups) * len(knots) + 1
    heights = 3 * count + np.arange(len(groups) * len(knots)).reshape(len(groups), -1)
    rows, most = list[Array](), list[Array]()
    for piece, span in enumerate(spans):
        for number, curve in enumerate(groups):
            alpha = headings_at(curve, span, FEW_HEADINGS)
            k, a, b = visits(curve, span, alpha, knots, 0.0)
            row = np.zeros((len(k), size))
            moved = np.exp(1j * alpha[k]) * (
                curve.planar[knots[b]] - curve.planar[knots[a]]
            )
            row[:, 2 * piece], row[:, 2 * piece + 1] = moved.real, moved.imag
            each = np.arange(len(k))
            row[each, heights[number, b]] += 1.0
            row[each, heights[number, a]] -= 1.0
            times = curve.times[np.abs(knots[b] - knots[a])]
            row[:, -1] = times - curve.times[0] if overlapped else 0.0
            rows.append(row)
            most.append(times)
    for number, curve in enumerate(groups):
        row = np.zeros((2 * len(knots) - 2, size))
        each = np.arange(len(knots) - 1)
        for sign, part in ((1.0, row[: len(each)]), (-1.0, row[len(each) :])):
            part[each, heights[number, 1:]], part[each, heights[number, :-1]] = (
                sign,
                -sign,
            )
        allowed = curve.slope * curve.spacing * EVERY
        row[:, -1] = -allowed if overlapped else 0.0
        rows.append(row)
        most.append(np.full(len(row), 0.0 if overlapped else allowed))
    angles = np.arange(DIRECTIONS) * 2 * pi / DIRECTIONS
    for piece in range(count):  # the length of lambda
        row = np.zeros((DIRECTIONS, size))
        row[:, 2 * piece], row[:, 2 * piece + 1] = np.cos(angles), np.sin(angles)
        row[:, 2 * count + piece] = -1.0
        rows.append(row)
        most.append(np.zeros(DIRECTIONS))
    cost = np.zeros(size)
    cost[: 2 * count], cost[2 * count : 3 * count] = -ways.ravel(), loose
    free = [(None, None)] * (size - 1) + [(0.0, 1.0)]
    from scipy.optimize import linprog  # slow to import, and seldom needed

    found = linprog(cost, np.vstack(rows), np.concatenate(most), bounds=free)
    if found.status != 0:
        return None
    grid = np.arange(ANGLES)
    values = [np.interp(grid, knots, found.x[own]) for own in heights]
    share = float(found.x[-1]) if overlapped else 0.0
    return found.x[: 2 * count].reshape(-1, 2), np.array(values), share


def _largest_rate(
    curve: Curve, span: tuple[float, float], lead: Array, height: Array, weight: float
) -> float:
    """What rho has to be for a piece and a curve."""
    alpha = headings_at(curve, span, None)
    size, apart = float(np.linalg.norm(lead)), float(alpha[1] - alpha[0])
    reach = float(np.abs(curve.planar[:, None] - curve.planar).max())
    missed = size * (2 * curve.spacing**2 * curve.bend + apart**2 * reach) / 8
    room = apart + np.abs(np.diff(curve.headings)).max()
    k, a, b = visits(curve, span, alpha, np.arange(ANGLES), room)
    lead_of = (lead[0] - 1j * lead[1]) * np.exp(1j * alpha)
    gained = (lead_of[k] * (curve.planar[b] - curve.planar[a])).real
    gained += height[b] - height[a] + missed
    lifts = curve.times[0]
    times = lifts + weight * (curve.times[np.abs(b - a)] - lifts)
    rough = size * ROUGH * np.abs(b - a) * curve.spacing
    return float(((gained + rough) / times).max())


def top_speed(setup: Setup) -> float:
    """Largest speed that a stroke of a plan gives the body [m/s]."""
    described, twists = setup.equations, real_twists(setup)
    low, high = np.array(list(described.limits.values())).T
    if len(low) <= MOST_GRIDDED:
        even = [np.linspace(0, 1, SWEPT_ANGLES)] * len(low)
        shares = np.stack(np.meshgrid(*even), axis=-1).reshape(-1, len(low))
    else:
        shares = np.random.default_rng(0).uniform(size=(DRAWN_ANGLES, len(low)))
    swing, fastest = low + shares * (high - low), 0.0
    for name in set(described.elements) & set(described.swings):
        direction = np.array(described.swings[name])
        rates = direction / np.abs(direction).max() * setup.limits.swing_speed
        stratum = described.system.stratum_of[name]
        velocity = twists(stratum, swing, np.broadcast_to(rates, swing.shape))
        fastest = max(fastest, float(np.hypot(*velocity[:, :2].T).max()))
    return fastest


def shortest_way(points: Array, within: float) -> float:
    """A lower bound on a way through circles around points (K, 2), in their order [m].

    The way begins at the first point and ends at the last one. Some of the points are
    left out, so that the sum of what lies between the circles of the others is largest.
    """
    radii = np.full(len(points), within)
    radii[[0, -1]] = 0.0
    longest = np.zeros(len(points))
    for k in range(1, len(points)):
        apart = np.linalg.norm(points[:k] - points[k], axis=1) - radii[:k] - radii[k]
        longest[k] = (longest[:k] + apart).max()
    return max(float(longest[-1]), 0.0)
