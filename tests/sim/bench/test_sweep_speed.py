"""The measurements of sweeps run; no speed is judged."""

import pytest

from sim.bench.sweep_speed import TINY, throughput
from sim.scenarios.file import load_scenario


@pytest.mark.physics
def test_throughput_is_measured_against_a_bare_batch():
    ratio, rate = throughput(load_scenario("line", TINY | {"timestep": 0.002}))
    assert 0.05 < ratio.value < 1.5
    assert rate.value > 0
