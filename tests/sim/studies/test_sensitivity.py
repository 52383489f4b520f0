"""Which settings matter, on functions whose Sobol indices are known."""

import re
from dataclasses import replace

import numpy as np
import pytest

from sim.studies.findings import explained, findings, group
from sim.studies.results import Results, read_results
from sim.sweeps.table import write_table

RNG = np.random.default_rng(16)


def test_ishigamis_indices_are_found_from_scattered_points():
    x = RNG.uniform(-np.pi, np.pi, (8000, 3))
    y = (
        np.sin(x[:, 0])
        + 7 * np.sin(x[:, 1]) ** 2
        + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    )
    found = [explained(column.tolist(), y, exact=False) for column in x.T]
    # Groups of neighbours blur the exact 0.3139, 0.4424, 0 by 0.02, measured.
    assert found == pytest.approx([0.3139, 0.4424, 0.0], abs=0.03)


def test_a_grid_gives_exact_shares():
    a, b = (axis.ravel() for axis in np.meshgrid(np.arange(20), np.arange(20)))
    shares = [explained(column.tolist(), 2.0 * a + b, exact=True) for column in (a, b)]
    assert shares == pytest.approx([0.8, 0.2])  # of the variance


@pytest.mark.parametrize("lost", [0, 1])
def test_a_study_of_a_full_grid_is_exact_and_says_so(lost):
    a, b = (axis.ravel() for axis in np.meshgrid(np.arange(3), np.arange(5)))
    columns = {
        "point": [*range(15)], "a": a.tolist(), "b": b.tolist(),
        "status": ["ok"] * (15 - lost) + ["none"] * lost,
        "verdict": ["missed"] * (15 - lost) + [None] * lost,
        "path_length": [1.0] * 15, "distance_walked": [1.0] * 15,
        "error.ideal.farthest": (10.0 ** -(a + b)).tolist(),
    }  # fmt: skip
    results = Results(columns, ("a", "b"), "ideal")
    found = findings(results)
    assert found.verdicts == {"arrived": 0, "missed": 15 - lost}
    part = findings(replace(results, asked={"vary": {"a": [0] * 3, "b": [0] * 6}}))
    assert part.method.endswith("14 points" if lost else "exact for these 15 points")
    if lost:
        assert found.method.endswith("estimated from 14 points")
        assert found.explained["b"].falls == pytest.approx(2 / 7)  # of 14/225 in all
    else:
        assert found.method.endswith("exact for this full grid of 15 points")
        shares = [found.explained[key].departure for key in "ab"]
        assert shares == pytest.approx([0.25, 0.75])  # variances 2/3 and 2
        assert found.together.departure == pytest.approx(0.0, abs=1e-12)


def test_what_only_settings_together_explain_is_told_of_a_full_grid():
    a, b = (axis.ravel() for axis in np.meshgrid(np.arange(2), np.arange(2)))
    columns = {
        "point": [*range(4)], "a": a.tolist(), "b": b.tolist(), "status": ["ok"] * 4,
        "verdict": ["arrived"] * 4, "path_length": [1.0] * 4,
        "distance_walked": [1.0] * 4, "error.ideal.farthest": [0.01, 0.1, 0.1, 0.01],
    }  # fmt: skip
    found = findings(Results(columns, ("a", "b"), "ideal"))
    assert [found.explained[key].departure for key in "ab"] == [0.0, 0.0]
    assert found.together.departure == 1.0
    assert re.search(r"^several together +100% +-$", str(found), re.MULTILINE)


def test_a_setting_that_does_nothing_explains_nothing():
    nothing = RNG.integers(0, 4, 400).tolist()
    assert explained(nothing, RNG.normal(size=400), exact=False) < 0.03


def test_words_are_groups_and_unknown_results_are_left_out():
    words = ["a", "b"] * 10
    results = np.array([0.0, 1.0] * 9 + [np.nan, 1.0])
    assert explained(words, results, exact=False) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("values", "results"),
    [
        pytest.param([1, 1, 1], [0.0, 1.0, 2.0], id="one value"),
        pytest.param([1, 2, 3], [0.0, 1.0, 2.0], id="a point each"),
        pytest.param([1, 1, 2], [3.0, 3.0, 3.0], id="one result"),
    ],
)
def test_nothing_is_said_where_nothing_can_be(values, results):
    assert explained(values, np.array(results), exact=False) is None


def test_many_values_make_groups_of_a_dozen_in_order():
    groups = group(np.linspace(0, 1, 96).tolist())
    assert (np.diff(groups) >= 0).all()
    assert np.bincount(groups).tolist() == [12] * 8


def test_walks_are_compared_with_the_prediction_that_their_verdicts_are_by(tmp_path):
    rows = [
        {
            "point": number, "friction": 0.1 * number, "status": "ok",
            "verdict": "arrived", "path_length": 0.1, "distance_walked": 1.0,
            "weighed.prediction": "compliant", "error.compliant.farthest": 0.0005,
            "error.quasi_static.farthest": 0.01,
        }
        for number in range(3)
    ]  # fmt: skip
    asked = {"vary": {"friction": []}, "scenario": {"name": "line"}, "set": {}}
    about = {"asked": asked, "software": {}}
    write_table(tmp_path / "table.parquet", rows, about)
    same, other = (findings(read_results(tmp_path, p)) for p in ("", "quasi_static"))
    assert same.classes["within 1 %"] == other.classes["within 10 %"] == 3
    assert "\nverdicts: arrived 3\n" in str(same)
    assert "\nverdicts, by the compliant prediction: arrived 3\n" in str(other)


@pytest.mark.parametrize("count", [13, 19, 20, 199])
def test_nothing_explains_results_that_are_all_the_same(count):
    """Their mean is off by what was rounded, of which a setting could explain all."""
    assert explained([*range(5)] * count, np.full(5 * count, 0.0123), True) is None
