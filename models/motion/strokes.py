"""Strokes: twists integrated along the swings of loaded legs.

A stroke is a straight motion of the groups' angles during which a moving group is in
contact. Strokes follow one another on a clock on which each takes one unit: first the
yaw is integrated, then the position. In the panels into which they are divided the
integrand is the polynomial through its values at the Gauss-Legendre nodes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import compress

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from models.contact.dissipation import foot_velocities
from models.contact.kinematics import Kinematics
from models.motion.twists import TwistModel
from planner import Array

PANEL_NODES = 4  # exact for integrands of degree 7 over a panel
_POINTS, _WEIGHTS = legendre.leggauss(PANEL_NODES)


def _integrals(u: Array) -> Array:
    """Integrals from 0 to u of the shifted Legendre polynomials, (..., PANEL_NODES)."""
    P = legendre.legvander(2 * u - 1, PANEL_NODES)  # (..., PANEL_NODES + 1)
    higher = (P[..., 2:] - P[..., :-2]) / (2 * (2 * np.arange(1, PANEL_NODES) + 1))
    return np.concatenate([u[..., None], higher], axis=-1)


# Values at the nodes -> Legendre coefficients -> integrals from the panel's start.
_COEFFICIENTS = np.linalg.inv(legendre.legvander(_POINTS, PANEL_NODES - 1))
FRACTIONS = (_POINTS + 1) / 2  # where the nodes lie in a panel
_TO_PANEL_NODES = _integrals(FRACTIONS) @ _COEFFICIENTS  # (PANEL_NODES, PANEL_NODES)


@dataclass(frozen=True, eq=False)
class Integral:
    """The integral of a vector function from the start of the first panel."""

    edges: Array  # ends of the panels on the clock, increasing, shape (P + 1,)
    values: Array  # integrand by the panel's clock (0 to 1), (P, PANEL_NODES, C)

    def __call__(self, clock: Array) -> Array:
        """The integral up to some moments, (M,) to (M, C); constant beyond the ends."""
        if len(self.values) == 0:
            return np.zeros((len(clock), self.values.shape[-1]))
        panel = np.searchsorted(self.edges, clock, side="right") - 1
        panel = np.clip(panel, 0, len(self.values) - 1)
        begin, end = self.edges[panel], self.edges[panel + 1]
        u = np.clip((clock - begin) / (end - begin), 0.0, 1.0)
        weights = _integrals(u) @ _COEFFICIENTS  # (M, PANEL_NODES)
        inside = np.einsum("mn,mnc->mc", weights, self.values[panel])
        return self._starts[panel] + inside

    def at_nodes(self) -> Array:
        """The integral at every node, shape (P, PANEL_NODES, C)."""
        inside = np.einsum("jn,pnc->pjc", _TO_PANEL_NODES, self.values)
        return self._starts[:-1, None] + inside

    @property
    def total(self) -> Array:
        """The integral over all panels, shape (C,)."""
        return self._starts[-1]

    @cached_property
    def _starts(self) -> Array:
        """The integral at every edge, shape (P + 1, C)."""
        whole = np.einsum("n,pnc->pc", _WEIGHTS / 2, self.values)
        return np.pad(np.cumsum(whole, axis=0), ((1, 0), (0, 0)))


Move = tuple[str, ArrayLike]  # stratum, and change of every group's angle [rad]
PANEL = 0.05  # [rad]; longest part of a stroke that is one panel of integration


@dataclass(frozen=True)
class Travel:
    """Pose and slip as functions of the strokes' clock, in the frame of the start."""

    pose: Integral  # x, y [m], yaw [rad], not wrapped
    _slip_rates: Callable[[], Array]

    @cached_property
    def slip(self) -> Integral:
        """Slip of each foot [m]."""
        return Integral(self.pose.edges, self._slip_rates())


@dataclass(frozen=True, eq=False)
class Strokes:
    """Strokes in time order."""

    strata: tuple[str, ...]  # groups in contact, for each stroke
    begin: Array  # angles at the start, shape (S, G) [rad]
    change: Array  # shape (S, G) [rad]

    @classmethod
    def among(
        cls, moves: Sequence[Move], groups: Sequence[str], start: ArrayLike
    ) -> "tuple[Strokes, Array]":
        """The strokes among consecutive moves, and which of these they are, (moves,).

        The angles of the groups before the first move have shape (G,) [rad].
        """
        strata = tuple(stratum for stratum, _ in moves)
        change = np.array([c for _, c in moves], float).reshape(-1, len(groups))
        standing = np.array([[g in s for g in groups] for s in strata], bool)
        loaded = ((change != 0) & standing.reshape(change.shape)).any(axis=1)
        begin = np.cumsum(change, axis=0) - change + np.asarray(start, float)
        on = tuple(compress(strata, loaded))
        return cls(on, begin[loaded], change[loaded]), loaded

    def travel(self, twists: TwistModel, kinematics: Kinematics) -> Travel:
        """Integrate body twist and foot slip along the strokes."""
        panels = _Panels(self)
        twist = panels.evaluate(twists)  # (P, n, 3)
        yaw = Integral(panels.edges, twist[..., 2:]).at_nodes()[..., 0]
        cos, sin = np.cos(yaw), np.sin(yaw)
        forward, left, turn = np.moveaxis(twist, -1, 0)
        velocity = (forward * cos - left * sin, forward * sin + left * cos, turn)
        pose = Integral(panels.edges, np.stack(velocity, axis=-1))
        return Travel(pose, partial(panels.slip_rates, twist, kinematics))


class _Panels:
    """Parts of strokes that are short enough for a polynomial, with angles at nodes."""

    def __init__(self, strokes: Strokes) -> None:
        largest = np.abs(strokes.change).max(axis=1, initial=0.0)
        pieces = np.maximum(np.ceil(largest / PANEL - 1e-9), 1).astype(int)  # (S,)
        self.stroke = np.repeat(np.arange(len(pieces)), pieces)  # (P,)
        first = np.repeat(np.cumsum(pieces) - pieces, pieces)
        count = pieces[self.stroke]
        begin = (np.arange(len(self.stroke)) - first) / count
        self.edges = np.append(self.stroke + begin, float(len(pieces)))
        way = begin[:, None] + FRACTIONS / count[:, None]  # (P, n)
        start = strokes.begin[self.stroke]  # (P, G)
        change = strokes.change[self.stroke]
        self.swing = start[:, None] + way[..., None] * change[:, None]
        rates = (change / count[:, None])[:, None]
        self.rates = np.broadcast_to(rates, self.swing.shape)
        self.strata = np.array(strokes.strata, dtype=object)[self.stroke]

    def evaluate(self, twists: TwistModel) -> Array:
        """Twist at every node, by the panel's own clock, shape (P, n, 3)."""
        out = np.zeros((*self.swing.shape[:2], 3))
        for stratum in sorted(set(self.strata)):
            on = self.strata == stratum
            swing, rates = self.swing[on], self.rates[on]
            groups = swing.shape[-1]
            flat = twists(stratum, swing.reshape(-1, groups), rates.reshape(-1, groups))
            out[on] = flat.reshape(-1, PANEL_NODES, 3)
        return out

    def slip_rates(self, twist: Array, kinematics: Kinematics) -> Array:
        """Speed over the ground of the feet in contact, shape (P, n, F)."""
        robot = kinematics.robot
        stance = kinematics.stance(self.swing)
        moved = stance.rates * self.rates[..., robot.group_of_leg, None]
        speed = np.linalg.norm(foot_velocities(stance.feet, moved, twist), axis=-1)
        planted = np.array([robot.planted(stratum) for stratum in self.strata])
        return speed * planted.reshape(-1, 1, len(robot.legs))
