"""Which settings matter, on functions whose Sobol indices are known."""

import numpy as np
import pytest

from sim.studies.results import explained, group

RNG = np.random.default_rng(16)


def test_ishigamis_indices_are_found_from_scattered_points():
    x = RNG.uniform(-np.pi, np.pi, (8000, 3))
    y = (
        np.sin(x[:, 0])
        + 7 * np.sin(x[:, 1]) ** 2
        + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    )
    found = [explained(column.tolist(), y) for column in x.T]
    # Groups of neighbours blur the exact 0.3139, 0.4424, 0 by 0.02, measured.
    assert found == pytest.approx([0.3139, 0.4424, 0.0], abs=0.03)


def test_a_grid_gives_exact_shares():
    a, b = (axis.ravel() for axis in np.meshgrid(np.arange(5), np.arange(5)))
    shares = [explained(column.tolist(), 2.0 * a + b) for column in (a, b)]
    raw = [0.8, 0.2]  # of the variance; chance takes a little
    chance = [1 - (1 - share) * 24 / 20 for share in raw]
    assert shares == pytest.approx(chance)


def test_a_setting_that_does_nothing_explains_nothing():
    nothing = RNG.integers(0, 4, 400).tolist()
    assert explained(nothing, RNG.normal(size=400)) < 0.03


def test_words_are_groups_and_unknown_results_are_left_out():
    words = ["a", "b"] * 10
    results = np.array([0.0, 1.0] * 9 + [np.nan, 1.0])
    assert explained(words, results) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("values", "results"),
    [
        pytest.param([1, 1, 1], [0.0, 1.0, 2.0], id="one value"),
        pytest.param([1, 2, 3], [0.0, 1.0, 2.0], id="a point each"),
        pytest.param([1, 1, 2], [3.0, 3.0, 3.0], id="one result"),
    ],
)
def test_nothing_is_said_where_nothing_can_be(values, results):
    assert explained(values, np.array(results)) is None


def test_many_values_make_groups_of_a_dozen_in_order():
    groups = group(np.linspace(0, 1, 96).tolist())
    assert (np.diff(groups) >= 0).all()
    assert np.bincount(groups).tolist() == [12] * 8
