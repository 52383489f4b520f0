"""Drawings of a report: what is left out of their curves, and where axes begin."""

import numpy as np
import pytest

from sim.reports import panels
from sim.reports.drawing import extremes
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
    monkeypatch.setattr(panels, "finish", lambda figure, *_: figure.axes[0].get_ylim())
    curves = [(np.linspace(1.0, 2.0, len(run.time)), {})]
    low, _ = panels._curves(run, "", curves, [], bottom=0)
    assert low == 0
    low, _ = panels._curves(run, "", curves, [])
    assert 0.9 < low < 1
