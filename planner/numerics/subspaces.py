"""Subspaces as columns of a matrix: bases, complements, and directions as text."""

from collections.abc import Iterable

import numpy as np

from planner.numerics.arrays import ROUNDING, Array

SPANNED = 1e-8  # relative singular values above it count towards the rank


def column_space(columns: Array) -> Array:
    """Orthonormal columns of the same span; columns are scaled to length one first."""
    left, singular = _decomposed(columns)
    return left[:, singular > SPANNED]


def nearly_dependent(columns: Array) -> bool:
    """Whether the rank is in doubt, because a column is nearly in the others' span."""
    _, singular = _decomposed(columns)
    return bool(((singular > ROUNDING) & (singular <= SPANNED)).any())


def _decomposed(columns: Array) -> tuple[Array, Array]:
    sizes = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(sizes > 0, sizes, 1.0)
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    return left, singular


def rank(columns: Array) -> int:
    """Dimension of the space that columns span, each scaled to length one."""
    return int(column_space(columns).shape[1])


def null_space(rows: Array) -> Array:
    """Orthonormal columns orthogonal to all rows."""
    _, singular, right = np.linalg.svd(rows)
    return right[int((singular > SPANNED).sum()) :].T


def sparse_basis(columns: Array) -> Array:
    """A basis of the same space with many zeros: its reduced echelon form."""
    rows, done = columns.T.copy(), 0
    for k in range(rows.shape[1]):
        if done == len(rows):
            break
        pivot = done + int(np.abs(rows[done:, k]).argmax())
        if abs(rows[pivot, k]) > SPANNED:
            rows[[done, pivot]] = rows[[pivot, done]]
            rows[done] /= rows[done, k]
            others = np.arange(len(rows)) != done
            rows[others] -= np.outer(rows[others, k], rows[done])
            done += 1
    return rows.T


def directions_beyond(columns: Array, names: Iterable[object]) -> tuple[str, ...]:
    """Directions orthogonal to all columns, as text."""
    names = tuple(names)
    directions = sparse_basis(null_space(column_space(columns).T))
    return tuple(in_words(direction, names) for direction in directions.T)


def in_words(direction: Array, names: Iterable[object]) -> str:
    """A direction as a sum of coordinates, `x - 0.5 y`."""
    words = ""
    for value, name in zip(direction.tolist(), names, strict=True):
        if abs(value) > SPANNED:
            size = "" if abs(abs(value) - 1) < SPANNED else f"{abs(value):.3g} "
            sign = "-" if value < 0 else "+"
            words += f" {sign} {size}{name}" if words else f"{sign}{size}{name}"
    return words.removeprefix("+")
