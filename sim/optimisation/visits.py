"""What visits of a stratum can do: the curves of the body while one group strokes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from planner import Array, Flow
from planner.optimisation import Stage, Task
from sim.optimisation.judging import Judge
from sim.preparation.setup import Setup

ANGLES = 61  # of a group, between the ends of its range
FINE_ANGLES = 20  # times as many, to integrate by
LEAST_STROKE = 1e-9  # [rad], of a visit that only lifts and lands
ROUNDED_STEPS = 3  # of physics, to which a visit is rounded up at most
HEADINGS = 0.005  # [rad] between two values of alpha on the grid at least
MOST_HEADINGS = 200  # of them
ROOM = 1.01  # of second derivatives that are known at the fine angles alone


@dataclass(frozen=True, eq=False)
class Curve:
    """The body's curve while one group strokes, and the time that strokes take."""

    coordinate: int  # of the group's angle in the state
    angles: Array  # of the group, evenly spaced, shape (k,) [rad]
    places: Array  # G of the docstring above, shape (k, 2) [m]
    headings: Array  # Y, shape (k,) [rad]
    bend: float  # second derivative of G at most [m/rad^2]
    times: Array  # T of strokes from the first angle to each, shape (k,) [s]
    slope: float  # of V at most, the time of a recovery [s/rad]

    @property
    def spacing(self) -> float:
        """Distance of two angles [rad]."""
        return float(self.angles[1] - self.angles[0])

    @property
    def planar(self) -> Array:
        """G as complex numbers [m]."""
        return np.asarray(self.places @ [1.0, 1.0j])

    @property
    def spare(self) -> float:
        """Time that two parts of a visit may take beyond the whole [s]."""
        steady = self.times - (self.times[-1] - self.times[-2]) / self.spacing * (
            self.angles - self.angles[0]
        )
        return float(steady.max())


def curves(setup: Setup, task: Task) -> Iterator[Curve | None]:
    """Curves of all stages with strokes; None for one without, or on all feet."""
    for stage in task.stages:
        if stage.stroke:
            yield _curve(setup, task, stage)


def _curve(setup: Setup, task: Task, stage: Stage) -> Curve | None:
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
    place = integrated(turn)
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
    places = np.column_stack([place.real, place.imag])[::FINE_ANGLES]
    return Curve(own, angles, places, heading[::FINE_ANGLES], bend, times, slope)


def headings_at(curve: Curve, span: tuple[float, float], count: int | None) -> Array:
    """Values of alpha, evenly spaced, at which the heading may be in a span."""
    low, high = span[0] - curve.headings.max(), span[1] - curve.headings.min()
    high = min(high, low + 2 * pi) if np.isfinite(low) else pi
    low = low if np.isfinite(low) else -pi
    most = min(MOST_HEADINGS, 2 + int((high - low) / HEADINGS))
    return np.linspace(low, high, count or most)


def visits(
    curve: Curve,
    span: tuple[float, float],
    alpha: Array,
    knots: Array,
    room: float,
) -> tuple[Array, Array, Array]:
    """Indices of alpha, and of knots a and b, between which headings are in a span.

    The span is widened by a room on both sides.
    """
    heading = alpha[:, None] + curve.headings[knots]
    inside = (heading >= span[0] - room) & (heading <= span[1] + room)
    both = inside[:, :, None] & inside[:, None, :]
    k, a, b = np.nonzero(both)
    return k, a, b
