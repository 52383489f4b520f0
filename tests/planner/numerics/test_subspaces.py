"""Spans, complements and directions as text, checked by what they are defined by."""

import numpy as np
import pytest

from planner.numerics.subspaces import (
    column_space,
    directions_beyond,
    in_words,
    nearly_dependent,
    null_space,
    rank,
    sparse_basis,
)

COLUMNS = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 3.0], [1.0, 2.0, 0.0], [0.0, 0.0, 0.0]])


def projector(columns):
    return columns @ np.linalg.pinv(columns)


def test_a_column_space_is_orthonormal_and_spans_the_same():
    found = column_space(COLUMNS)
    assert found.shape == (4, 2)
    assert found.T @ found == pytest.approx(np.eye(2), abs=1e-12)
    assert projector(found) == pytest.approx(projector(COLUMNS), abs=1e-12)


@pytest.mark.parametrize("size", [1e-12, 1.0, 1e12])
def test_rank_does_not_depend_on_the_lengths_of_columns(size):
    assert rank(COLUMNS * [1.0, 1.0, size]) == 2
    assert rank(0.0 * COLUMNS) == 0


@pytest.mark.parametrize(
    ("angle", "ranked", "doubtful"),
    [(1e-3, 2, False), (1e-9, 1, True), (0.0, 1, False)],
)
def test_rank_is_in_doubt_where_columns_are_nearly_parallel(angle, ranked, doubtful):
    columns = np.array([[1.0, 1.0], [0.0, angle]])
    assert rank(columns) == ranked
    assert nearly_dependent(columns) is doubtful


def test_a_null_space_is_all_that_is_orthogonal_to_rows():
    found = null_space(COLUMNS.T)
    assert found.T @ found == pytest.approx(np.eye(2), abs=1e-12)
    assert COLUMNS.T @ found == pytest.approx(np.zeros((3, 2)), abs=1e-12)


def test_a_sparse_basis_is_an_echelon_form_of_the_same_span():
    mixed = np.array([[2.0, 1.0], [0.0, 0.0], [4.0, 3.0], [2.0, -1.0]])
    found = sparse_basis(mixed)
    assert projector(found) == pytest.approx(projector(mixed), abs=1e-12)
    assert found[[0, 2]] == pytest.approx(np.eye(2), abs=1e-12)
    assert not found[1].any()


def test_directions_beyond_are_those_that_are_not_reached():
    assert directions_beyond(COLUMNS, "xyzw") == ("x - z", "w")
    assert directions_beyond(np.eye(3), "xyz") == ()


@pytest.mark.parametrize(
    ("direction", "words"),
    [
        ([1, 0, -0.5], "x - 0.5 z"),
        ([-1, 2, 0], "-x + 2 y"),
        ([0, 0.25, 1], "0.25 y + z"),
        ([1e-9, -1 + 1e-9, 0], "-y"),  # rounding is left out
    ],
)
def test_a_direction_in_words_is_a_sum_of_coordinates(direction, words):
    assert in_words(np.array(direction, dtype=float), "xyz") == words
