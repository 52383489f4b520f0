"""Involutive closure: the Lie algebra that fields generate, degree by degree.

Left-normed brackets [g, B] of generators with what is known span each next degree. A
degree that adds nothing, as fields and not merely at one point, ends the algebra: then
its rank anywhere is final. A rank that stalls at one point says nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from planner.elements import name_of
from planner.fields import (
    Array,
    Symbols,
    VectorField,
    compile_fields,
    lie_bracket,
    sample_configurations,
)

LARGEST = 150  # fields, beyond which an algebra is not followed further
INDEPENDENT = 1e-8  # part of a field's size that must be new
ZERO = 1e-9  # size of a field that counts as none
POINTS = 80  # configurations at which fields are compared
Named = tuple[str, VectorField]


@dataclass(frozen=True, eq=False)
class Involution:
    """Fields that span a Lie algebra up to a depth.

    Attributes:
        names: Names of the fields, generators first.
        fields: The fields, linearly independent over the reals.
        depth: Highest degree that was looked at.
        complete: Whether the next degree adds nothing.
        state: Symbols of the state.
    """

    names: tuple[str, ...]
    fields: tuple[VectorField, ...]
    depth: int
    complete: bool
    state: Symbols

    def at(self, x: Array) -> Array:
        """The fields at a configuration, as columns of shape (n, fields)."""
        return compile_fields(self.fields, self.state, self.names)(x)


def involutive_closure(
    generators: Mapping[str, VectorField],
    state: Symbols,
    max_depth: int,
    until: Callable[[Involution], bool] = lambda algebra: False,
) -> Involution:
    """The Lie algebra of fields: complete, or as far as asked for.

    Args:
        generators: Fields by name.
        state: Symbols of the state.
        max_depth: Highest degree of brackets to form, at least 1.
        until: Says after each degree whether the algebra found suffices.
    """
    if max_depth < 1:
        raise ValueError(f"depth is {max_depth}; at least 1 is needed")
    span = _Span(state, generators.values())
    roots = span.extend(generators.items())
    known, newest = roots, roots
    algebra = _algebra(known, 1, not newest, state)
    while not (
        algebra.complete
        or algebra.depth == max_depth
        or len(known) > LARGEST
        or until(algebra)
    ):
        newest = span.extend(
            (name_of((a, b)), lie_bracket(f, g, state))
            for a, f in roots
            for b, g in newest
            if a != b
        )
        known = known + newest
        algebra = _algebra(known, algebra.depth + bool(newest), not newest, state)
    return algebra


def _algebra(
    known: list[Named], depth: int, complete: bool, state: Symbols
) -> Involution:
    names = tuple(name for name, _ in known)
    return Involution(names, tuple(f for _, f in known), depth, complete, state)


class _Span:
    """Real span of fields, each a vector of its values at random configurations."""

    def __init__(self, state: Symbols, generators: Iterable[VectorField]) -> None:
        self._state = state
        points = sample_configurations(len(state), POINTS)
        values = compile_fields(list(generators), state).values(points)
        self._points = points[np.isfinite(values).all(axis=(1, 2))]
        self._directions = np.empty((0, self._points.size))

    def extend(self, fields: Iterable[tuple[str, VectorField]]) -> list[Named]:
        """Take in fields; those that are new are returned."""
        fields = list(fields)
        compiled = compile_fields([field for _, field in fields], self._state)
        values = np.moveaxis(compiled.values(self._points), -1, 0)
        vectors = values.reshape(len(fields), self._points.size)
        return [
            f for f, vector in zip(fields, vectors, strict=True) if self._is_new(vector)
        ]

    def _is_new(self, vector: Array) -> bool:
        size = np.linalg.norm(vector)
        if not size > ZERO:
            return False
        rest = vector / size
        for _ in range(2):  # once more against rounding
            rest = rest - self._directions.T @ (self._directions @ rest)
        left = np.linalg.norm(rest)
        if left > INDEPENDENT:
            self._directions = np.vstack([self._directions, rest / left])
        return bool(left > INDEPENDENT)
