"""Drawings of a report: what is left out of their curves, and where axes begin."""

from dataclasses import replace

import numpy as np
import pytest

from sim import palette
from sim.reports import maps, panels, tables
from sim.reports.drawing import extremes, extremes_between, stretches
from sim.runs.run import read_run


def test_thinned_curves_keep_the_extremes_of_every_stretch():
    values = np.random.default_rng(3).normal(size=(4000, 2))
    rows = extremes(values, bins=20)
    assert len(rows) <= 2 + 20 * 2 * 2
    assert {0, 3999} <= set(rows)
    for start in range(0, 4000, 200):
        kept = values[rows[(rows >= start) & (rows < start + 200)]]
        whole = values[start : start + 200]
        assert np.array_equal(kept.min(axis=0), whole.min(axis=0))
        assert np.array_equal(kept.max(axis=0), whole.max(axis=0))


@pytest.mark.physics
def test_an_axis_begins_where_it_is_told_to(walked, monkeypatch):
    run = read_run(walked)
    monkeypatch.setattr(
        panels.drawing, "finish", lambda figure, *_: figure.axes[0].get_ylim()
    )
    curves = [(np.linspace(1.0, 2.0, len(run.time)), {}, None)]
    low, _ = panels._curves(run, "", curves, bottom=0)
    assert low == 0
    low, _ = panels._curves(run, "", curves)
    assert 0.9 < low < 1


@pytest.mark.physics
def test_errors_along_and_across_are_those_in_x_and_y_turned_with_the_path(walked):
    run = read_run(walked)
    ahead, left = maps._turned(run, "ideal").T
    x, y = run.error("ideal")[:, :2].T
    direction = run.nominal[-1, :2] - run.nominal[0, :2]  # the path is straight
    cos, sin = direction / np.hypot(*direction)
    np.testing.assert_allclose(ahead, cos * x + sin * y, atol=1e-15)
    np.testing.assert_allclose(left, cos * y - sin * x, atol=1e-15)


@pytest.mark.physics
def test_a_stratum_of_one_group_has_no_second_entry_for_that_groups_colour(walked):
    *_, contacts = panels.panels(read_run(walked))
    keys = {key.label: key.colour for key in contacts.keys}
    assert len(set(keys.values())) == len(keys)
    assert "stratum 12" in keys


@pytest.mark.physics
def test_long_walks_have_bands_until_the_page_is_zoomed(walked, monkeypatch):
    run = read_run(walked)
    starts = stretches(run)
    low, high = extremes_between(run.margin, starts)
    assert (low.min(), high.max()) == (run.margin.min(), run.margin.max())
    assert not any('class="band"' in drawn.svg for drawn in panels.panels(run))
    monkeypatch.setattr(panels, "COMB", 1)
    margin = list(panels.panels(run))[2].svg
    assert [margin.count(f'class="{name}"') for name in ("band", "detail")] == [2, 2]
    slip = list(panels.panels(run))[3].svg  # which only rises, and is no comb
    assert "detail" not in slip


def test_the_key_shows_the_dashes_of_every_prediction(walked):
    run = read_run(walked)
    off = next(panels.panels(run))
    drawn = [palette.PREDICTED[name].dashes for name in run.compared]
    assert [key.dashes for key in off.keys] == drawn
    page = (walked / "report.html").read_text()
    for dashes in filter(None, drawn):
        lengths = " ".join(f"{2.4 * part}" for part in dashes)
        assert f'stroke-dasharray="{lengths} "' in page


def test_the_path_of_a_walk_that_turns_has_arrows_ahead(walked):
    drawn = []
    for turn in (0.3, 0.0):
        run = read_run(walked)
        nominal, achieved = run.nominal.copy(), run.achieved.copy()
        for poses in (nominal, achieved):
            poses[:, 2] = np.linspace(0.0, turn, len(poses))
        run.__dict__.update(nominal=nominal, achieved=achieved)
        drawn.append(maps.plan_view(run))
    turned, straight = drawn
    assert "Arrows point" in turned.note
    assert "Arrows point" not in straight.note
    arrows = turned.svg.count("<path ") - straight.svg.count("<path ")
    assert arrows == min(maps.ARROWS, len(stretches(run)) + 1) > 1


def test_the_reason_of_slip_is_given_where_it_was_foreseen(walked):
    run = read_run(walked)
    assert "feet of legs with two joints have to slide" in tables.sentences(run)[3]
    achieved = replace(run.summary.achieved, slip=10 * run.summary.achieved.slip)
    lost = replace(run, summary=replace(run.summary, achieved=achieved))
    assert "prediction has only" in tables.sentences(lost)[3]
    missed = replace(run, summary=replace(run.summary, verdict="missed"))
    assert "normal" not in tables.sentences(missed)[3]
    played = replace(run, summary=replace(run.summary, goal=None))  # on no path
    assert "normal: feet of legs with two joints" in tables.sentences(played)[3]
