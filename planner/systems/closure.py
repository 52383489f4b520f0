"""Involutive closure: the Lie algebra that fields generate, degree by degree (Sec. 4).

Each degree is spanned by brackets [g, B] of generators with the fields of the degree
before; once a degree adds no new field, the rank at any configuration is final. That
the rank at one configuration does not grow proves nothing, so fields are compared at
configurations around it. Where rounding could decide, `exact_rank` uses fractions.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from planner.errors import SingularConfigurationError
from planner.numerics.arrays import ROUNDING, Array
from planner.numerics.subspaces import rank
from planner.systems.fields import NumericField, Symbols, VectorField, lie_bracket
from planner.systems.rounding import WeighedValues

MOST_FIELDS = 150  # number of fields at which the search ends
MOST_OPERATIONS = 50_000  # in their formulas, likewise: some two seconds
CALL_OPERATIONS = 10  # operations that a call of a Python function counts as
INDEPENDENT = ROUNDING  # part of a new field outside the span; less may be rounding
PROBES = 80  # configurations where fields are compared
NEAREST = 1e-3  # half of them lie within 1 in each coordinate, the others down to this
MOST_ENTRIES = 400  # of a matrix whose exact rank is found
Named = tuple[str, VectorField]


@dataclass(frozen=True, eq=False)
class LieClosure:
    """Independent fields that span the involutive closure of a distribution."""

    names: tuple[str, ...]  # generators first
    fields: tuple[VectorField, ...]
    columns: Array  # their values at the given configuration, shape (n, fields)
    depth: int  # highest degree of brackets that was formed
    complete: bool  # whether the next degree adds no field

    @property
    def rank(self) -> int:
        """Rank of the fields at the configuration."""
        return rank(self.columns)


def involutive_closure(
    generators: Mapping[str, VectorField],
    state: Symbols,
    at: ArrayLike,
    max_depth: int,
    enough: int | None = None,
) -> LieClosure:
    """The involutive closure of fields around a configuration of shape (n,).

    The search ends at `max_depth`, once the rank at the configuration is `enough`, or
    if there are too many fields or too long formulas. Raises
    `SingularConfigurationError` if a field is not finite at the configuration.
    """
    if max_depth < 1:
        raise ValueError(f"depth is {max_depth}; at least 1 is needed")
    span = _Span(state, np.asarray(at, dtype=float), [*generators.values()])
    roots = newest = span.extend(generators.items())
    algebra = span.algebra(1, complete=not newest)
    while not (algebra.complete or algebra.depth == max_depth or span.full):
        if algebra.rank == enough:
            break
        newest = span.extend(
            (f"[{a},{b}]", lie_bracket(f, g, state))
            for a, f in roots
            for b, g in newest
            if a != b
        )
        algebra = span.algebra(algebra.depth + bool(newest), complete=not newest)
    return algebra


class _Span:
    """The span of fields, each a vector of its values around a configuration."""

    def __init__(self, state: Symbols, at: Array, roots: list[VectorField]) -> None:
        spread = np.ones((PROBES, 1))
        spread[PROBES // 2 :, 0] = np.geomspace(1.0, NEAREST, PROBES - PROBES // 2)
        spread[0] = 0.0  # the configuration itself
        offsets = np.random.default_rng(0).uniform(-1.0, 1.0, (PROBES, at.size))
        self._evaluation = WeighedValues(state, at + spread * offsets)
        self._sound = np.ones(PROBES, dtype=bool)  # points where all fields are finite
        # places where generators are large would drown the others
        sizes = [np.abs(self._evaluation(root)).max(axis=1) for root in roots]
        self._share = 1 / np.max(np.nan_to_num([*sizes, np.ones(PROBES)]), axis=0)
        self._directions = np.empty((PROBES * at.size, 0))
        self._columns = np.empty((at.size, 0))
        self._known: list[Named] = []
        self._operations = 0  # in the formulas of all fields met

    @property
    def full(self) -> bool:
        """Whether there are too many fields, or more than the points distinguish."""
        told_apart = int(self._sound.sum()) * len(self._columns) // 2
        many = len(self._known) > min(MOST_FIELDS, told_apart)
        return many or self._operations > MOST_OPERATIONS

    def algebra(self, depth: int, complete: bool) -> LieClosure:
        """The algebra found so far; a degree that was cut short does not count."""
        names, fields = zip(*self._known, strict=True) if self._known else ((), ())
        if self.full:
            depth, complete = max(1, depth - 1), False
        return LieClosure(names, fields, self._columns, depth, complete)

    def extend(self, fields: Iterable[Named]) -> list[Named]:
        """Add fields until there are too many, and return the independent ones."""
        before = len(self._known)
        for name, field in fields:
            numeric = isinstance(field, NumericField)
            calls = CALL_OPERATIONS * field.calls if numeric else sp.count_ops(field)
            self._operations += int(calls)
            values = self._evaluation(field)  # (PROBES, n)
            sound = np.all(np.isfinite(values), axis=1)
            if not sound[0]:
                raise SingularConfigurationError(name, self._evaluation.points[0])
            if not sound[self._sound].all():
                self._sound &= sound
                rows = np.repeat(self._sound, len(self._columns))
                self._directions, _ = np.linalg.qr(self._directions * rows[:, None])
            weighed = np.where(self._sound[:, None], values * self._share[:, None], 0.0)
            if self._is_new(weighed.ravel()):
                self._known.append((name, field))
                self._columns = np.column_stack([self._columns, values[0]])
            if self.full:
                break
        return self._known[before:]

    def _is_new(self, vector: Array) -> bool:
        size = np.linalg.norm(vector)
        if size == 0.0:
            return False
        rest = vector / size
        for _ in range(2):  # twice, against rounding
            rest = rest - self._directions @ (self._directions.T @ rest)
        left = np.linalg.norm(rest)
        if left > INDEPENDENT:
            self._directions = np.column_stack([self._directions, rest / left])
        return bool(left > INDEPENDENT)


def exact_rank(fields: Iterable[VectorField], state: Symbols, at: Array) -> int | None:
    """Rank of fields at a configuration in rational arithmetic.

    Every number is taken as the decimal that it was written as. None where a field is a
    function or has an irrational value there, or the matrix has too many entries.
    """
    columns = list(fields)
    by_functions = any(isinstance(field, NumericField) for field in columns)
    if by_functions or len(columns) * len(state) > MOST_ENTRIES:
        return None
    place = {s: _decimal(value) for s, value in zip(state, at.tolist(), strict=True)}

    def exact(entry: sp.Expr) -> sp.Expr:
        floats = {number: _decimal(float(number)) for number in entry.atoms(sp.Float)}
        return entry.xreplace(floats).subs(place)

    values = [[exact(entry) for entry in field] for field in columns]
    if not all(entry.is_Rational for column in values for entry in column):
        return None
    return int(sp.Matrix(values).rank()) if values else 0


def _decimal(number: float) -> sp.Rational:
    """The decimal that a float was written as: 0.1 + 0.2 is 0.3 then."""
    return sp.Rational(f"{number:.15g}")
