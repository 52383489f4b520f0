"""Vehicles in the plane: systems that are the same wherever they stand and face.

Two coordinates are a place in the plane, and some others, the headings, turn along when
the plane is turned; no field depends on the place. A chart of such a system, turned by
any angle, is a chart again. A vehicle whose headings differ much, such as a trailer
across behind its car, drives until they are nearly equal: no chart holds it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations

import numpy as np
import sympy as sp

from planner.errors import PlannerError, message, point
from planner.numerics.arrays import Array
from planner.planning.rollouts import play
from planner.systems.fields import CompiledFields, compile_fields, sample_configurations
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

SAME = 1e-9  # relative, of what an invariance demands to be equal
ALIGNED = 0.8  # [rad] between two headings of a vehicle that a chart holds well
STEERED = (0.0, 1.1, -1.1)  # values of the steered coordinate on the way to that
STEP = 0.25  # [rad] of the fastest heading in a step of it
MOST_LAYERS = 200
SUBSTEPS = 4  # of the integration in the search for it

Way = tuple[tuple[float, float], ...]  # steered value; 1 forward, -1 backward


@dataclass(frozen=True, eq=False)
class Plane:
    """How the plane's motions act on a system with a field to drive and one to steer.

    The steering field moves one coordinate alone, at a constant rate.
    """

    system: StratifiedSystem
    outputs: tuple[sp.Expr, sp.Expr]  # a place that turns along with the vehicle
    place: tuple[int, int]  # indices of x and y
    headings: tuple[int, ...]
    drive: str
    steer: str
    steered: int  # index of the coordinate that `steer` moves

    @classmethod
    def of(
        cls,
        system: StratifiedSystem,
        outputs: tuple[sp.Expr, sp.Expr],
        drive: str,
        steer: str,
    ) -> "Plane | None":
        """The plane's motions of a system; None if it has no such invariance."""
        state, fields = system.state, system.fields
        along, across = outputs
        found = [
            (i, j)
            for (i, x), (j, y) in permutations(enumerate(state), 2)
            if not (along - x).has(x) and not (across - y).has(y)
            if not any(f.has(x) or f.has(y) for f in fields.values())
        ]
        moved = [i for i, entry in enumerate(fields[steer]) if entry != 0]
        if not found or len(moved) != 1 or fields[steer][moved[0]].free_symbols:
            return None
        place = found[0]
        headings = _headings(system, place, drive)
        own = cls(system, outputs, place, headings, drive, steer, moved[0])
        return own if headings and own._turns_outputs else None

    @property
    def _turns_outputs(self) -> bool:
        """Whether the outputs turn along with the plane."""
        points = sample_configurations(len(self.system.state))
        turned = np.array([self.turned(x, 0.7) for x in points])
        cos, sin = np.cos(0.7), np.sin(0.7)
        there = self.at(points) @ [[cos, sin], [-sin, cos]]
        return np.allclose(self.at(turned), there, rtol=SAME, atol=SAME)

    def at(self, x: Array) -> Array:
        """The place of the outputs at configurations (..., n), shape (..., 2)."""
        return self._place.velocity(x)

    def turned(self, x: Array, angle: float) -> Array:
        """A configuration (n,) with the plane turned about its origin [rad]."""
        cos, sin, found = np.cos(angle), np.sin(angle), np.array(x, dtype=float)
        i, j = self.place
        found[[i, j]] = cos * x[i] - sin * x[j], sin * x[i] + cos * x[j]
        found[list(self.headings)] += angle
        return found

    def chart(
        self, system: StratifiedSystem, z: Sequence[sp.Expr], angle: float
    ) -> tuple[StratifiedSystem, tuple[sp.Expr, ...]]:
        """Fields and coordinates of a chart, turned by an angle."""
        cos, sin, (i, j) = np.cos(angle), np.sin(angle), self.place
        state = self.system.state
        x, y = state[i], state[j]
        back = {state[k]: state[k] - angle for k in self.headings}
        back |= {x: cos * x + sin * y, y: cos * y - sin * x}
        fields = {}
        for name, field in system.fields.items():
            column = [entry.xreplace(back) for entry in field]
            a, b = column[i], column[j]
            column[i], column[j] = cos * a - sin * b, sin * a + cos * b
            fields[name] = column
        charted = replace(system, strata={system.bottom: fields})
        return charted, tuple(entry.xreplace(back) for entry in z)

    def direction(self, x: Array) -> float:
        """The direction in which the outputs move, near the mean of the headings."""
        a, b = self._velocity.velocity(x)
        mean = float(np.mean(x[list(self.headings)]))
        return mean + (float(np.arctan2(b, a)) - mean + np.pi) % (2 * np.pi) - np.pi

    def aligned(self, place: Array, heading: float) -> Array:
        """The configuration with outputs at a place (2,) and all headings equal."""
        x = np.zeros(self.system.dimension)
        x[list(self.headings)] = heading
        x[list(self.place)] = place - self.at(x)
        return x

    def way_in(self, x: Array) -> tuple[list[Flow], Array]:
        """Flows that bring headings near each other, and where they lead, (n,).

        They are the shortest on a grid, of steps that drive forward or backward with
        the wheels steered to one of a few angles.
        """
        rate = float(self.system.fields[self.steer][self.steered])
        if self._spread(x[None])[0] <= ALIGNED:
            apart = self.steered not in self.headings
            turned_far = apart and abs(x[self.steered]) > ALIGNED
            return self._followed(x, (), rate) if turned_far else ([], x)
        moves = [(value, step) for value in STEERED for step in (1.0, -1.0)]
        layer, ways, seen = x[None], [Way()], set[bytes]()
        for _ in range(MOST_LAYERS):
            after = np.concatenate([self._driven(layer, *move) for move in moves])
            ways = [(*way, move) for move in moves for way in ways]
            good = np.flatnonzero(self._spread(after) <= ALIGNED)
            if good.size:
                return self._followed(x, ways[good[0]], rate)
            differences = self._differences(after) / 0.125  # [rad] are the same
            cells, fresh = np.round(differences).astype(np.int16), list[int]()
            for k, cell in enumerate(cells):
                if cell.tobytes() not in seen:
                    seen.add(cell.tobytes())
                    fresh.append(k)
            layer, ways = after[fresh], [ways[k] for k in fresh]
        raise PlannerError(message("headings", place=point(x)))

    def _followed(self, x: Array, way: Way, rate: float) -> tuple[list[Flow], Array]:
        """The flows of steps, joined where the wheels stay, and where they lead."""
        bottom, flows, at = self.system.bottom, list[Flow](), x[self.steered]
        for value, step in (*way, (0.0, 0.0)):
            if value != at:
                flows.append(Flow(bottom, self.steer, float(value - at) / rate))
                at = value
            if step and flows and flows[-1].field == self.drive:
                step += flows.pop().duration / self._step
            if step:
                flows.append(Flow(bottom, self.drive, step * self._step))
        return flows, play(self.system, flows, x)[-1]

    @property
    def _driving(self) -> Callable[[Array], Array]:
        """Velocities (..., n) of driving at configurations likewise."""
        return self.system.compiled(self.drive).velocity

    def _driven(self, layer: Array, value: float, direction: float) -> Array:
        """Configurations (k, n) after a step, by the classical Runge-Kutta method."""
        h, x, rates = direction * self._step / SUBSTEPS, layer.copy(), self._driving
        x[:, self.steered] = value
        for _ in range(SUBSTEPS):
            k1 = rates(x)
            k2 = rates(x + h / 2 * k1)
            k3 = rates(x + h / 2 * k2)
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rates(x + h * k3))
        return x

    def _differences(self, x: Array) -> Array:
        return np.asarray(np.diff(x[:, list(self.headings)], axis=1))

    def _spread(self, x: Array) -> Array:
        """Largest difference between neighbouring headings, shape (k,)."""
        return np.abs(self._differences(x)).max(axis=1, initial=0.0)

    @cached_property
    def _step(self) -> float:
        """Duration of a step of driving."""
        x = np.zeros(self.system.dimension)
        x[self.steered] = max(STEERED)
        fastest = np.abs(self._driving(x)[list(self.headings)]).max()
        return STEP / max(float(fastest), SAME)

    @cached_property
    def _place(self) -> CompiledFields:
        return compile_fields([sp.Matrix(self.outputs)], self.system.state)

    @cached_property
    def _velocity(self) -> CompiledFields:
        drive, state = self.system.fields[self.drive], self.system.state
        rates = sp.Matrix(self.outputs).jacobian(state) * sp.Matrix(drive)
        return compile_fields([rates], state)


def _headings(
    system: StratifiedSystem, place: tuple[int, int], drive: str
) -> tuple[int, ...]:
    """Coordinates that turn with the plane so that a field turns too; () if none do.

    The field f is invariant under x' = -y, y' = x, theta_i' = c_i if the sum of
    c_i df/dtheta_i is f with its x and y turned by a right angle.
    """
    state, (i, j) = system.state, place
    field = sp.Matrix(system.fields[drive])
    turned = sp.zeros(len(state), 1)
    turned[i], turned[j] = -field[j], field[i]
    others = [k for k in range(len(state)) if k not in place]
    columns = [field.diff(state[k]) for k in others]
    points = sample_configurations(len(state))
    values = compile_fields([*columns, turned], state).values(points)
    rows = values.reshape(-1, len(others) + 1)
    factors, *_ = np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=None)
    found = tuple(k for k, c in zip(others, factors, strict=True) if abs(c - 1) < SAME)
    rest = np.abs(rows[:, -1] - rows[:, [others.index(k) for k in found]].sum(axis=1))
    return found if rest.max() <= SAME * (1 + np.abs(rows).max()) else ()
