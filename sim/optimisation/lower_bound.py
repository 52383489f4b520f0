"""A time that every walk along a path takes at least; docs/short-walks.md proves it.

On a visit of a stratum one group strokes from angle a to angle b, which moves the body
along a curve G with headings alpha + Y and takes at least T(|b - a|). Let V of each
group's angle be no steeper than its recovery is slow. If on all visits

    lambda . R(alpha) (G(b) - G(a)) + V(b) - V(a) <= rho T(|b - a|),    rho >= 1,    (*)

the walk takes at least lambda . (goal - start) / rho. A linear program proposes lambda
and V of each piece of the path; rho is then found on a grid of all visits.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, pi

import numpy as np

from planner import Array, Flow
from planner.optimisation import Stage, Task
from sim.optimisation.judging import ROUGH, Judge, real_twists, task_of
from sim.preparation.setup import Setup

ANGLES = 61  # of a group, between the ends of its range
FINE_ANGLES = 20  # times as many, to integrate by
LEAST_STROKE = 1e-9  # [rad], of a visit that only lifts and lands
ROUNDED_STEPS = 3  # of physics, to which a visit is rounded up at most
HEADINGS = 0.005  # [rad] between two values of alpha on the grid at least
ROOM = 1.01  # of second derivatives that are known at the fine angles alone
PIECES = (1, 2, 3, 4)  # numbers of them that are tried
EVERY = 4  # of these, in the linear program
FEW_HEADINGS = 64  # in the linear program
DIRECTIONS = 32  # in which the length of a vector is compared
MOST_GRIDDED = 2  # groups


@dataclass(frozen=True, eq=False)
class Curve:
    """The body's curve while one group strokes, and the time that strokes take."""

    angles: Array  # of the group, evenly spaced, shape (k,) [rad]
    planar: Array  # G as complex numbers, shape (k,) [m]
    headings: Array  # Y, shape (k,) [rad]
    bend: float  # second derivative of G at most [m/rad^2]
    times: Array  # T of strokes from the first angle to each, shape (k,) [s]
    slope: float  # of V at most, the time of a recovery [s/rad]

    @property
    def spacing(self) -> float:
        """Distance of two angles [rad]."""
        return float(self.angles[1] - self.angles[0])

    @property
    def spare(self) -> float:
        """Time that two parts of a visit may take beyond the whole [s]."""
        pace = (self.times[-1] - self.times[-2]) / self.spacing
        return float((self.times - pace * (self.angles - self.angles[0])).max())


def least_time(setup: Setup, within: float, yaw: float = inf) -> float:
    """Time that any walk along the path takes at least [s], without holds.

    The body may depart from the path by `within` [m], and from its yaw [rad].

    Example:
        >>> from sim import least_time, load_scenario, prepare
        >>> setup = prepare(load_scenario("line"))
        >>> least_time(setup, within=0.02, yaw=0.17) > 50  # [s]
        True
    """
    points = setup.scenario.path.curve.at(np.linspace(0.0, 1.0, 101))
    plain = shortest_way(points[:, :2], within) / top_speed(setup)
    task = task_of(setup, (within, yaw))
    found = [_curve(setup, task, stage) for stage in task.stages if stage.stroke]
    known = [curve for curve in found if curve is not None]
    if not known or len(known) < len(found):
        return plain
    proven = (_proven(setup, known, points, within, yaw, k) for k in PIECES)
    return float(max(plain, *proven))


def _curve(setup: Setup, task: Task, stage: Stage) -> Curve | None:
    """The curve of a stage's stroke; None if it depends on more, or on all feet."""
    system, judge = task.system, Judge(setup)
    state, column = system.state, system.fields[stage.stroke]
    rates = {i: rate for i, rate in task.rates(stage).items() if i > 2}
    if stage.stratum == system.bottom or len(rates) != 1:
        return None
    ((own, rate),) = rates.items()
    if column.free_symbols - {state[2], state[own]}:
        return None
    low, high = task.limits[own]
    angles = np.linspace(low, high, ANGLES)
    fine = np.linspace(low, high, (ANGLES - 1) * FINE_ANGLES + 1)
    states = np.zeros((len(fine), len(state)))
    states[:, own] = fine
    velocity = system.compiled(stage.stroke).values(states)[:, :, 0] / rate

    def integrated(rows: Array) -> Array:
        steps = (rows[1:] + rows[:-1]) / 2 * (fine[1] - fine[0])
        return np.concatenate([[0.0], np.cumsum(steps)])

    heading = integrated(velocity[:, 2])
    heading -= np.interp(0.0, fine, heading)
    turn = np.exp(1j * heading) * (velocity[:, 0] + 1j * velocity[:, 1])
    bend = ROOM * float(np.abs(np.gradient(turn, fine)).max())

    lengths = np.maximum(angles - low, LEAST_STROKE) / rate
    flows = ([Flow(stage.stratum, stage.stroke, length)] for length in lengths.tolist())
    times = np.array([judge.duration(flow) for flow in flows])
    others = {s.stratum for s in task.stages} - {stage.stratum}
    direct = min((system.switches(stage.stratum, other) for other in others), default=2)
    lifts = 2 * system.switches(system.bottom, stage.stratum)
    times -= ROUNDED_STEPS * setup.limits.timestep
    times -= times[0] * max(0.0, 1 - direct / lifts)  # shared with other visits
    prices = [
        task.cost(recovery.field) / abs(recovery.rate)
        for other in task.stages
        for recovery in other.recoveries
        if recovery.coordinate == own
    ]
    slope = 0.0 if task.centred or not prices else min(prices)
    coarse = slice(None, None, FINE_ANGLES)
    return Curve(angles, integrated(turn)[coarse], heading[coarse], bend, times, slope)


def _headings(curve: Curve, span: tuple[float, float], count: int | None) -> Array:
    """Values of alpha, evenly spaced, at which the heading may be in a span."""
    low, high = span[0] - curve.headings.max(), span[1] - curve.headings.min()
    high = min(high, low + 2 * pi) if np.isfinite(low) else pi
    low = low if np.isfinite(low) else -pi
    return np.linspace(low, high, count or min(200, 2 + int((high - low) / HEADINGS)))


def _visits(
    curve: Curve, span: tuple[float, float], alpha: Array, knots: Array, room: float
) -> tuple[Array, Array, Array]:
    """Indices of alpha and of knots a, b with headings in a span, widened by room."""
    heading = alpha[:, None] + curve.headings[knots]
    inside = (heading >= span[0] - room) & (heading <= span[1] + room)
    k, a, b = np.nonzero(inside[:, :, None] & inside[:, None, :])
    return k, a, b


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
    turns = [points[a : b + 1, 2] for a, b in pairwise(cuts)]
    spans = [(float(turn.min() - yaw), float(turn.max() + yaw)) for turn in turns]
    ways = np.diff(points[cuts, :2], axis=0)
    radii = np.full(count + 1, within)
    radii[[0, -1]] = 0.0
    loose = radii[1:] + radii[:-1]
    overlapped = setup.scenario.overlap_recovery
    if (found := _certificate(groups, spans, ways, loose, overlapped)) is None:
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
            alpha = _headings(curve, span, FEW_HEADINGS)
            k, a, b = _visits(curve, span, alpha, knots, 0.0)
            row = np.eye(size)[heights[number, b]] - np.eye(size)[heights[number, a]]
            way = curve.planar[knots[b]] - curve.planar[knots[a]]
            moved = np.exp(1j * alpha[k]) * way
            row[:, 2 * piece], row[:, 2 * piece + 1] = moved.real, moved.imag
            times = curve.times[np.abs(knots[b] - knots[a])]
            row[:, -1] = times - curve.times[0] if overlapped else 0.0
            rows.append(row)
            most.append(times)
    for number, curve in enumerate(groups):
        steps = np.eye(size)[heights[number, 1:]] - np.eye(size)[heights[number, :-1]]
        row, allowed = np.vstack([steps, -steps]), curve.slope * curve.spacing * EVERY
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
    values = [np.interp(np.arange(ANGLES), knots, found.x[own]) for own in heights]
    share = float(found.x[-1]) if overlapped else 0.0
    return found.x[: 2 * count].reshape(-1, 2), np.array(values), share


def _largest_rate(
    curve: Curve, span: tuple[float, float], lead: Array, height: Array, weight: float
) -> float:
    """What rho has to be for a piece and a curve."""
    alpha = _headings(curve, span, None)
    size, apart = float(np.linalg.norm(lead)), float(alpha[1] - alpha[0])
    reach = float(np.abs(curve.planar[:, None] - curve.planar).max())
    missed = size * (2 * curve.spacing**2 * curve.bend + apart**2 * reach) / 8
    room = apart + np.abs(np.diff(curve.headings)).max()
    k, a, b = _visits(curve, span, alpha, np.arange(ANGLES), room)
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
        even = [np.linspace(0, 1, 25)] * len(low)  # ends of the joint range included
        shares = np.stack(np.meshgrid(*even), axis=-1).reshape(-1, len(low))
    else:
        shares = np.random.default_rng(0).uniform(size=(4000, len(low)))
    swing, fastest = low + shares * (high - low), 0.0
    for name in set(described.elements) & set(described.swings):
        direction = described.swings[name]
        widest = setup.limits.farthest(direction, 1.0)
        rates = np.array(direction) / widest * setup.limits.swing_speed
        stratum = described.system.stratum_of[name]
        velocity = twists(stratum, swing, np.broadcast_to(rates, swing.shape))
        fastest = max(fastest, float(np.hypot(*velocity[:, :2].T).max()))
    return fastest


def shortest_way(points: Array, within: float) -> float:
    """A lower bound on a way through circles around points (K, 2), in their order [m].

    The way begins at the first point and ends at the last one. Points are left out so
    that the sum of what lies between the circles of the others is largest.
    """
    radii = np.full(len(points), within)
    radii[[0, -1]] = 0.0
    longest = np.zeros(len(points))
    for k in range(1, len(points)):
        apart = np.linalg.norm(points[:k] - points[k], axis=1) - radii[:k] - radii[k]
        longest[k] = (longest[:k] + apart).max()
    return max(float(longest[-1]), 0.0)
