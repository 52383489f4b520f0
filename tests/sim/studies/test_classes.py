"""Classes, groups and shares of a study, on tables that are written by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.errors import UsageError
from sim.studies import maps
from sim.studies.findings import Explained, Findings, _left, explained, findings, group
from sim.studies.results import ROUND, _require
from tests.studies import results


def test_points_are_within_limits_up_to_and_including_them():
    found = results([0.0, 0.01, 0.0101, 0.03, 0.0301, 0.1, 0.1001, None])
    assert found.classes.tolist() == [0, 0, 1, 1, 2, 2, 3, 5]
    assert found.counts == {
        "within 1 %": 2, "within 3 %": 2, "within 10 %": 2,
        "beyond": 1, "fell": 0, "no walk": 1,
    }  # fmt: skip
    assert found.walked.tolist() == [True] * 7 + [False]
    assert len(found) == 8


def test_a_robot_that_fell_is_in_a_class_of_its_own_however_near_it_was():
    words = ["arrived", "fell", "missed"]
    found = results([0.001, 0.001, 0.2], verdict=words)
    assert found.classes.tolist() == [0, 4, 3]


def test_walks_whose_prediction_could_not_be_made_are_left_out_and_counted():
    far = [0.02, None, None, 4.0, None]
    words = ["arrived", "arrived", None, "missed", "fell"]
    status = ["ok", "ok", "no way", "ok", "ok"]
    given = {"error.ideal.farthest": far, "verdict": words, "status": status}
    found = findings(results([0.1] * 5, **given).predicted())
    assert (found.points, found.left_out) == (4, 1)
    assert [n for n in found.classes.values() if n] == [1, 1, 1, 1]
    assert found.verdicts == {"arrived": 1, "missed": 1, "fell": 1}
    assert str(found).splitlines()[1] == (
        "1 walk left out, for which this prediction could not be made"
    )
    assert results([0.1, None]).predicted().left_out == 0


def test_a_part_of_a_sweep_is_not_called_all_of_it():
    given = results([0.1] * 4)
    part = replace(given, asked={"vary": {"a": [1, 2, 3], "b": [1, 2]}})
    found = findings(part)
    assert str(found).startswith("4 of the sweep's 6 points, each counted")
    page = maps.page(part, found, Path("t.parquet"), Path())
    assert "4 of the sweep&#39;s 6 points</h1>" in page
    assert str(findings(given)).startswith("4 points, each counted")
    assert str(findings(replace(given, asked={"vary": {"a": 5}}))).startswith(
        "4 points"
    )


def test_a_path_without_length_is_weighed_by_the_way_that_was_walked():
    found = results([0.1, 0.1], path_length=[0.0, 2.0], distance_walked=[4.0, 4.0])
    assert found.off == pytest.approx([0.05, 0.1])
    assert found.classes.tolist() == [2, 2]


def test_fitted_limits_are_round_and_just_above_thirds():
    rng = np.random.default_rng(0)
    shares = sorted(np.exp(rng.normal(-5, 1, 301)).tolist())
    limits = results(shares).fitted().limits
    thirds = np.quantile(shares, [1 / 3, 2 / 3, 1.0])
    for limit, third in zip(limits, thirds, strict=True):
        assert limit in ROUND
        assert third <= limit
        below = ROUND[limit * (1 - 1e-12) > ROUND][-1]
        assert below < third
    even = results([0.01] * 9).fitted().limits
    assert even == pytest.approx((0.01, 0.012, 0.015))
    assert results([None]).fitted().limits == (0.01, 0.03, 0.10)
    vast = results([1e9] * 3).fitted().limits
    assert vast == pytest.approx(tuple(ROUND[-3:]))
    fell = results([0.5, 0.001, 0.001], verdict=["fell", "arrived", "arrived"])
    assert max(fell.fitted().limits) < 0.01


def test_a_column_that_is_not_there_is_named():
    with pytest.raises(UsageError, match="no column 'patth_length'.*the table"):
        results([0.1]).column("patth_length")
    found = results([0.1, None]).column("path_length")
    assert found[0] == 2.0
    assert np.isnan(found[1])


@pytest.mark.parametrize(
    ("value", "fine"),
    [
        (0.0, True),
        (-1e-9, False),
        (1e12, True),
        (1.01e12, False),
        (True, False),
        ("x", False),
    ],
)
def test_numbers_of_a_table_are_from_0_to_a_million_million(value, fine):
    if fine:
        _require("c", [1.0, value], "numbers from 0", int, float)
        return
    with pytest.raises(UsageError, match="row 1 of column 'c'"):
        _require("c", [1.0, value], "numbers from 0", int, float)


@pytest.mark.parametrize(
    ("count", "groups"),
    [(12, 12), (13, 4), (60, 5), (61, 5), (72, 6), (288, 24), (600, 24)],
)
def test_more_than_a_dozen_values_are_in_groups_of_a_dozen_points(count, groups):
    found = group([float(k) for k in range(count)][::-1])
    assert len(set(found.tolist())) == groups
    assert (np.diff(found) <= 0).all()  # in their order
    sizes = np.bincount(found)
    assert sizes.max() - sizes.min() <= 1
    assert (
        len(set(group([float(k) for k in range(count)], separate=True).tolist()))
        == count
    )


def test_equal_values_are_one_group_whatever_their_type():
    assert group([2, 1.0, 2.0, 1]).tolist() == [1, 0, 1, 0]
    assert len(set(group([True, 1, "1"]).tolist())) == 3


def test_shares_are_the_variance_of_means_over_the_whole_one():
    values = [0.0] * 3 + [1.0] * 3 + [2.0] * 2
    y = np.array([1.0, 2.0, 3.0, 5.0, 5.0, 8.0, 1.0, 2.0])
    groups = [y[:3], y[3:6], y[6:]]
    within = sum(((g - g.mean()) ** 2).sum() for g in groups)
    total = ((y - y.mean()) ** 2).sum()
    assert explained(values, y, exact=True) == pytest.approx(1 - within / total)
    chance = (8 - 1) / (8 - 3)  # of as many means from as many points
    assert explained(values, y, exact=False) == pytest.approx(
        1 - chance * within / total
    )
    holes = np.append(y, np.nan)
    assert explained([*values, 7.0], holes, exact=True) == pytest.approx(
        1 - within / total
    )


@pytest.mark.parametrize(
    ("values", "y"),
    [
        ([1.0, 1.0, 1.0], [1.0, 2.0, 3.0]),  # one group
        ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),  # as many groups as points
        ([1.0, 1.0, 2.0], [4.0, 4.0, 4.0]),  # nothing differs
    ],
)
def test_where_nothing_can_be_explained_nothing_is_said(values, y):
    assert explained(values, np.array(y), exact=True) is None


@pytest.mark.parametrize(
    ("shares", "left"),
    [
        ([0.5, 0.2], 0.3), ([0.7, 0.5], 0.0), ([0.5, None], None),
        ([0.5], None), ([], None),
        ([0.1, 0.2, 0.3], 0.4),
    ],
)  # fmt: skip
def test_what_is_left_of_a_whole_is_known_if_all_shares_are(shares, left):
    assert _left(shares) == (None if left is None else pytest.approx(left))


def grid(lost=()):
    """Four by three points, whose order of magnitude is a sum of both settings."""
    a, b = (m.ravel().tolist() for m in np.meshgrid(range(4), range(3)))
    shares = [None if k in lost else 10.0 ** (-4 + 0.5 * x + 0.1 * y)
              for k, (x, y) in enumerate(zip(a, b, strict=True))]  # fmt: skip
    return results(shares, a=[float(x) for x in a], b=[float(y) for y in b])


def test_a_full_grid_of_sums_leaves_nothing_to_several_together():
    found = findings(grid())
    parts = {k: one.departure for k, one in found.explained.items()}
    variance = {"a": 0.25 * np.var(range(4)), "b": 0.01 * np.var(range(3))}
    whole = sum(variance.values())
    assert parts == {k: pytest.approx(v / whole) for k, v in variance.items()}
    assert found.together.departure == pytest.approx(0.0, abs=1e-9)
    assert "exact for this full grid of 12 points" in found.method
    assert [key for key, _ in found.ranked][:2] == ["a", "b"]
    assert found.verdicts == {"arrived": 12}
    assert (found.points, found.judge) == (12, "")


def test_a_grid_with_lost_points_is_exact_for_losses_and_estimated_for_the_rest():
    found = findings(grid(lost=(0, 4, 8)))
    assert "estimated from 9 points" in found.method
    assert found.together.departure is None
    assert found.explained["a"].falls == pytest.approx(1.0)
    assert found.explained["b"].falls == pytest.approx(0.0)
    assert found.together.falls == pytest.approx(0.0)
    assert found.reasons == {"no way": 3}
    twice = grid()
    doubled = replace(twice, columns={k: v * 2 for k, v in twice.columns.items()})
    assert "estimated" in findings(doubled).method


def test_reasons_are_the_five_most_frequent_without_their_numbers():
    status = [*["bad 1.5 mm", "bad 2e-3 mm"], *["c"] * 3, *"defgh"]
    found = findings(results([None] * 10, status=status))
    assert list(found.reasons)[:2] == ["c", "bad ... mm"]
    assert found.reasons["bad ... mm"] == 2
    assert len(found.reasons) == 5


def test_a_single_setting_is_not_divided_and_zero_is_rounding():
    found = findings(results([0.0, 1e-12, 1e-9, 0.1], a=[0.0, 0.0, 1.0, 1.0]))
    assert "only one setting varies" in found.method
    y = np.log10([1e-9, 1e-9, 1e-9, 0.1])
    best = explained([0.0, 0.0, 1.0, 1.0], y, exact=False)
    assert found.explained["a"].departure == pytest.approx(best)
    other = replace(results([0.1, 0.2]), judge="compliant")
    assert findings(other).judge == "compliant"


def test_settings_are_ranked_by_what_they_explain_and_several_come_last():
    parts = {
        "a": Explained(None, None),
        "b": Explained(0.2, 0.9),
        "c": Explained(0.5, 0.0),
    }
    made = Findings(1, "ideal", {}, parts, {}, {}, "", Explained(None, 0.1), "")
    assert [key for key, _ in made.ranked] == ["c", "b", "a", "several together"]
    alone = Findings(1, "ideal", {}, parts, {}, {}, "", Explained(None, None), "")
    assert [key for key, _ in alone.ranked] == ["c", "b", "a"]
