"""Fields of the real contacts: the body twist of each stroke as a function of the legs.

Every stroke's quasi-static twist is sampled at Chebyshev points of the joint range and
kept as a polynomial: a symbolic field like any other, with exact derivatives. One or
two groups of legs are covered as the whole rectangle of their angles; with more the
polynomial runs along the stroke alone, and holds for strokes centred at angle 0.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from numpy.polynomial import chebyshev

from models.motion.equations_of_motion import turned
from models.motion.robot_equations import Equations
from models.motion.twists import TwistModel
from planner import Array

STROKE_NODES = 13  # along it the twist is smooth but for where feet let go
ACROSS = 5  # along the angle of the other group, which matters through its weight alone
DROPPED = 3e-9  # [m/rad] and [rad/rad]; smaller coefficients are left out
UNSEEN = 200  # angles at which a fit is compared with what it was made from
WHOLE = 2  # groups up to which every combination of angles is covered


@dataclass(frozen=True, eq=False)
class ContactField:
    """The body twist of one stroke on one stratum, a polynomial in the legs' angles."""

    stratum: str  # groups in contact
    # change of every group's angle per unit of the stroke, (G,)
    direction: tuple[float, ...]
    axes: Array  # combinations of the groups' angles that the polynomial is of, (A, G)
    spans: Array  # lowest and highest value of each, (A, 2) [rad]
    # of forward, left and yaw by the Chebyshev polynomials of each combination,
    # scaled to its span, shape (3, ...) with A further axes
    coefficients: Array
    # largest difference from what was fitted, at angles that the fit has not
    # seen: forward, left [m/rad], yaw [rad/rad]
    error: tuple[float, float, float]

    def __call__(self, swing: Array) -> Array:
        """Body twist per unit of the stroke, (N, 3), at the groups' angles, (N, G)."""
        low, high = self.spans.T
        scaled = (2 * (swing @ self.axes.T) - low - high) / (high - low)
        out = np.moveaxis(self.coefficients, 0, -1)  # (..., 3)
        for axis, u in enumerate(scaled.T):
            basis = chebyshev.chebvander(u, self.coefficients.shape[1 + axis] - 1)
            out = np.einsum("nk,nk...->n..." if axis else "nk,k...->n...", basis, out)
        return out

    def expressions(self, angles: Sequence[sp.Symbol]) -> tuple[sp.Expr, ...]:
        """Forward, left and yaw as expressions over the groups' angles."""
        units = []
        for axis, (low, high) in zip(self.axes, self.spans, strict=True):
            shares = zip(map(float, axis), angles, strict=True)
            way = sum(share * angle for share, angle in shares)
            units.append((2 * way - float(low + high)) / float(high - low))
        forward, left, yaw = (_horner(part, units) for part in self.coefficients)
        return forward, left, yaw


def contact_fields(
    described: Equations,
    groups: Sequence[str],
    twists: TwistModel,
    names: Sequence[str] | None = None,
    dropped: float = DROPPED,
) -> dict[str, ContactField]:
    """Fit the twist of every stroke over the joint range, by the field's name.

    Only fields that swing a group in contact are fitted; coefficients smaller than
    `dropped` [m/rad], [rad/rad] are left out. The groups' names are in the order of the
    angles.
    """
    found = {}
    for name in described.swings if names is None else names:
        direction = described.swings[name]
        stratum = described.system.stratum_of[name]
        moving = [g for g, share in zip(groups, direction, strict=True) if share]
        if any(group in stratum for group in moving):
            spans = np.array([described.limits[f"phi_{group}"] for group in groups])
            found[name] = _fit(stratum, direction, spans, twists, dropped)
    return found


def contact_equations(
    described: Equations, fields: Mapping[str, ContactField]
) -> Equations:
    """The same equations, with strokes that move the body as the real contacts do."""
    system = described.system
    angles = system.state[3 : 3 + len(next(iter(described.swings.values())))]
    columns = dict(system.fields)
    for name, field in fields.items():
        velocity = turned(*field.expressions(angles))
        columns[name] = sp.ImmutableMatrix([*velocity, *columns[name][3:]])
    strata = {
        stratum: {name: columns[name] for name in names}
        for stratum, names in system.strata.items()
    }
    return replace(described, system=replace(system, strata=strata))


def _fit(
    stratum: str,
    direction: tuple[float, ...],
    spans: Array,
    twists: TwistModel,
    dropped: float,
) -> ContactField:
    """Interpolate a stroke's twist, and compare the two at other angles."""
    along = np.array(direction)
    axes = np.eye(len(along))
    if len(along) > WHOLE:
        axes = (along / (along @ along))[None]
        edges = [span / a for span, a in zip(spans, along, strict=True) if a]
        reach = np.abs(edges).min()
        spans = np.array([[-reach, reach]])
    low, high = spans.T
    lift = np.linalg.pinv(axes)  # from the combinations back to the angles, (G, A)

    def sampled(swing: Array) -> Array:
        return twists(stratum, swing, np.broadcast_to(along, swing.shape))

    nodes = [STROKE_NODES if axis @ along else ACROSS for axis in axes]
    points = [np.cos(np.pi * (np.arange(n) + 0.5) / n) for n in nodes]
    grid = np.stack(np.meshgrid(*points, indexing="ij"), axis=-1)
    ways = low + (grid.reshape(-1, len(axes)) + 1) / 2 * (high - low)
    coefficients = np.moveaxis(sampled(ways @ lift.T).reshape(*nodes, 3), -1, 0)
    for axis, u in enumerate(points, start=1):
        inverse = np.linalg.inv(chebyshev.chebvander(u, len(u) - 1))
        product = np.tensordot(inverse, coefficients, (1, axis))
        coefficients = np.moveaxis(product, 0, axis)
    coefficients = np.where(np.abs(coefficients) < dropped, 0.0, coefficients)
    for axis in range(1, coefficients.ndim):  # without degrees that are all zero
        used = coefficients.any(axis=tuple({*range(coefficients.ndim)} - {axis}))
        size = int(np.flatnonzero(used).max(initial=0)) + 1
        coefficients = np.take(coefficients, range(size), axis)
    field = ContactField(stratum, direction, axes, spans, coefficients, (0.0,) * 3)
    shares = np.random.default_rng(0).uniform(size=(UNSEEN, len(axes)))
    swing = (low + shares * (high - low)) @ lift.T
    gap = np.abs(field(swing) - sampled(swing)).max(axis=0)
    return replace(field, error=(float(gap[0]), float(gap[1]), float(gap[2])))


def _horner(coefficients: Array, units: Sequence[sp.Expr]) -> sp.Expr:
    """A Chebyshev series in several variables as nested polynomials."""
    if not units:
        return sp.Float(float(coefficients))
    first, *rest = units
    size = len(coefficients)
    columns = [chebyshev.cheb2poly(row) for row in np.eye(size)]
    to_powers = np.array([np.pad(c, (0, size - len(c))) for c in columns]).T
    value: sp.Expr = sp.S.Zero
    for part in np.tensordot(to_powers, coefficients, (1, 0))[::-1]:
        value = value * first + (_horner(part, rest) if np.any(part) else sp.S.Zero)
    return value
