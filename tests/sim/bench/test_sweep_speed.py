"""The measurements of sweeps run; no speed is judged."""

import pytest

from sim.bench import sweep_speed
from sim.bench.sweep_speed import TINY, throughput
from sim.scenarios.file import load_scenario


@pytest.mark.physics
def test_throughput_is_measured_against_a_bare_batch():
    ratio, rate = throughput(load_scenario("line", TINY | {"timestep": 0.002}))
    assert 0.05 < ratio.value < 1.5
    assert rate.value > 0


@pytest.mark.physics
def test_the_books_of_many_points_become_their_table(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep_speed, "LEDGER", 3)
    sweep_speed.keep_books(str(tmp_path))
    assert (tmp_path / "table.parquet").exists()
