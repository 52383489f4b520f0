"""Walks whose commands go elsewhere, as `drive` serves them."""

import pytest

from sim.export.served import served
from sim.scenarios.file import load_scenario


@pytest.mark.physics
def test_a_segment_in_which_nothing_moves_has_no_commands():
    still = {"segments": 2, "path.goal": [0.0, 0.0, 0.0]}
    walk = served(load_scenario("line", still))
    assert len([*walk.stand()]) > 1
    assert [*walk.walk(0)] == []
