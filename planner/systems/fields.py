"""Vector fields on the configuration space: brackets and fast evaluation, eq. (1).

They are the columns g_i of x' = g_1(x) u_1 + ... + g_m(x) u_m, a system without drift.
A field is a column of sympy expressions in the symbols of the state, or a
`NumericField` where it is known as a Python function only.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from planner.errors import FieldError, PlannerError, SingularConfigurationError, message
from planner.numerics.arrays import Array
from planner.support.stopping import tick

Symbols = tuple[sp.Symbol, ...]
VectorField = Any  # sp.ImmutableMatrix of shape (n, 1), or a NumericField

DIFFERENCE = 0.02  # of central differences; the extrapolation's error is of sixth order
PROBES = 12  # random points; an analytic field that vanishes at all of them is zero

KINKS = {"DiracDelta": lambda x, *_: np.where(x == 0, np.nan, 0.0)}
"""Derivative of `sign`: zero, except at the jump, where there is none."""


def bracket(f: sp.Matrix, g: sp.Matrix, x: Sequence[sp.Symbol]) -> sp.Matrix:
    """The Lie bracket [f, g] = (dg/dx) f - (df/dx) g of symbolic fields, Sec. 2.

    Both are columns with one expression for each symbol of the state x. `ValueError`
    says that a shape does not match it.

    Example:
        >>> from sympy import symbols
        >>> from planner import bracket
        >>> x, y, z = symbols("x y z")
        >>> list(bracket([1, 0, 0], [0, 1, x], (x, y, z)))
        [0, 0, 1]
    """
    f, g = (_column(field, len(x)) for field in (f, g))
    others = (f.free_symbols | g.free_symbols) - set(x)
    if namesakes := {str(s) for s in others} & {str(s) for s in x}:
        raise ValueError(message("namesake", name=min(namesakes)))

    def change(of: sp.Matrix, along: sp.Matrix) -> list[sp.Expr]:
        moving = [(s, speed) for s, speed in zip(x, along, strict=True) if speed != 0]
        found = []
        for entry in of:
            tick()  # slopes of nested functions take long
            parts = (entry.diff(s) * speed for s, speed in moving if entry.has(s))
            found.append(sp.Add(*parts))
        return found

    return sp.ImmutableMatrix(change(g, f)) - sp.ImmutableMatrix(change(f, g))


_remembered = lru_cache(maxsize=512)(bracket)  # higher degrees ask for the lower ones


def _column(field: sp.Matrix, size: int) -> sp.Matrix:
    if not isinstance(field, sp.MatrixBase):  # sympy.Matrix would run strings as code
        strictly = np.vectorize(lambda e: sp.sympify(e, strict=True), otypes=[object])
        field = strictly(np.atleast_1d(np.asarray(field, dtype=object)))
    column = sp.Matrix(field)
    if column.shape != (size, 1):
        raise ValueError(message("field_shape", shape=column.shape, size=size))
    return column


@dataclass(frozen=True, slots=True)
class NumericField:
    """A field that is known as a Python function only.

    Attributes:
        value: Maps one configuration, shape (n,), to a velocity, shape (n,).
        jacobian: Maps one configuration to the derivative of the field, shape (n, n).
            If it is not given, derivatives are extrapolated central differences.
        terms: Maps one configuration to the size of the terms whose sum is the
            velocity. If it is not given, they count as large as the velocity.
        calls: Number of calls of the caller's functions that one velocity takes.

    Example:
        >>> import numpy as np
        >>> from planner import NumericField
        >>> field = NumericField(lambda x: np.array([1.0, 0.0, x[0]]))
        >>> field(np.array([3.0, 0.0, 0.0]))
        array([1., 0., 3.])
    """

    value: Callable[[Array], ArrayLike]
    jacobian: Callable[[Array], ArrayLike] | None = None
    terms: Callable[[Array], float] | None = None
    calls: int = 1

    def __call__(self, x: Array) -> Array:
        """The velocity at one configuration, shape (n,)."""
        velocity = np.asarray(_called(self.value, x), dtype=float)
        if velocity.shape != x.shape:
            shapes = {"velocity": velocity.shape, "state": x.shape}
            raise ValueError(message("shape_of_field", **shapes))
        return velocity

    def weight(self, x: Array) -> float:
        """Size of the terms whose rounding errors the velocity contains."""
        return self.terms(x) if self.terms else float(np.linalg.norm(self(x)))

    def derivative(self, x: Array, direction: Array) -> Array:
        """Derivative of the field along a direction, both of shape (n,)."""
        if self.jacobian is not None:
            return np.asarray(_called(self.jacobian, x), dtype=float) @ direction
        return central_difference(self, x, direction)


def _called(function: Callable[[Array], ArrayLike], x: Array) -> ArrayLike:
    """The value of a user's function; its errors become those of the configuration."""
    try:
        return function(x)
    except (KeyboardInterrupt, PlannerError):
        raise
    except BaseException as error:  # sys.exit, too
        raise FieldError(x, error) from error


def central_difference(
    function: Callable[[Array], Array], x: Array, along: Array, step: float = DIFFERENCE
) -> Array:
    """Derivative of a function along a direction of any length, by central differences.

    Those of three step sizes, `step` the largest, are extrapolated to the sixth order.
    """
    size = float(np.linalg.norm(along))
    if size == 0.0:
        return np.zeros_like(function(x))
    unit = along / size

    def quotient(h: float) -> Array:
        return (function(x + h * unit) - function(x - h * unit)) / (2 * h)

    coarse, middle, fine = (quotient(step / 2**k) for k in range(3))
    return size * (64 * fine - 20 * middle + coarse) / 45


def lie_bracket(f: VectorField, g: VectorField, state: Symbols) -> VectorField:
    """The Lie bracket of fields of either kind, numeric if one of them is."""
    if not (isinstance(f, NumericField) or isinstance(g, NumericField)):
        return _remembered(f, g, state)
    f, g = as_numeric(f, state), as_numeric(g, state)

    def value(x: Array) -> Array:
        return g.derivative(x, f(x)) - f.derivative(x, g(x))

    def terms(x: Array) -> float:
        speeds = np.linalg.norm(f(x)), np.linalg.norm(g(x))
        return float(speeds[0] * g.weight(x) + speeds[1] * f.weight(x)) / DIFFERENCE

    return NumericField(value, None, terms, 7 * (f.calls + g.calls))


def as_numeric(field: VectorField, state: Symbols) -> NumericField:
    """A field as a function, with its exact derivative where it is symbolic."""
    if isinstance(field, NumericField):
        return field
    value = compile_fields([field], state)
    slopes = field.jacobian(sp.Matrix(state)).T.tolist()
    rows = compile_fields(list(map(sp.Matrix, slopes)), state)
    return NumericField(lambda x: value(x)[..., 0], rows)


@dataclass(frozen=True, eq=False, slots=True)
class CompiledFields:
    """Several fields, evaluated together at any number of configurations."""

    names: tuple[str, ...]
    constant: Array  # (n, p), the entries that do not depend on the configuration
    varying: tuple[tuple[int, int], ...]  # places of the entries that do
    function: Callable[..., Sequence[Array]]
    numeric: tuple[tuple[int, NumericField], ...]

    def __call__(self, x: ArrayLike) -> Array:
        """The fields as columns, shape (..., n, p), at configurations (..., n).

        Raises `SingularConfigurationError` if a field has no finite value at one of
        them.
        """
        x = np.asarray(x, dtype=float)
        columns = self.values(x)
        if not np.isfinite(columns).all():
            *where, _, j = np.argwhere(~np.isfinite(columns))[0]
            raise SingularConfigurationError(self.names[j], x[tuple(where)])
        return columns

    @property
    def is_constant(self) -> bool:
        """Whether no field depends on the configuration."""
        return not (self.varying or self.numeric)

    def velocity(self, x: Array) -> Array:
        """The first field at configurations (..., n), same shape; not always finite."""
        return self.values(x)[..., 0]

    def values(self, x: Array) -> Array:
        """The fields as columns, not finite where a field is singular."""
        columns = np.empty((*x.shape[:-1], *self.constant.shape))
        columns[...] = self.constant
        if self.varying:
            with np.errstate(all="ignore"):
                values = self.function(*(x.T if x.ndim == 2 else np.moveaxis(x, -1, 0)))
            for (i, j), value in zip(self.varying, values, strict=True):
                columns[..., i, j] = value
        for j, field in self.numeric:
            columns[..., j] = np.apply_along_axis(field, -1, x)
        return columns


def compile_fields(
    fields: Sequence[VectorField], state: Symbols, names: Sequence[str] = ()
) -> CompiledFields:
    """Columns of named fields as one numeric function that shares common terms."""
    rows = next((len(f) for f in fields if not isinstance(f, NumericField)), len(state))
    constant = np.zeros((rows, len(fields)))
    varying: dict[tuple[int, int], sp.Expr] = {}
    numeric: list[tuple[int, NumericField]] = []
    for j, field in enumerate(fields):
        if isinstance(field, NumericField):
            numeric.append((j, field))
            continue
        for i, entry in enumerate(field):
            if entry.free_symbols:
                varying[i, j] = entry
            else:
                constant[i, j] = float(entry)
    function = _function(tuple(state), tuple(varying.values()))
    names = tuple(names) or tuple(f"field {j + 1}" for j in range(len(fields)))
    return CompiledFields(names, constant, tuple(varying), function, tuple(numeric))


@lru_cache(maxsize=256)
def _function(state: tuple[sp.Symbol, ...], entries: tuple[sp.Expr, ...]) -> Any:
    """Entries as one function of the state; systems that are alike share it."""
    return sp.lambdify(state, entries, [KINKS, np], cse=True, dummify=True)


def sample_configurations(size: int, count: int = PROBES) -> Array:
    """Fixed random configurations, shape (count, size), the second half positive."""
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (count, size))
    points[count // 2 :] = np.abs(points[count // 2 :]) + 0.1
    return points
