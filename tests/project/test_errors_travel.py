"""Errors of walks made in other processes arrive as they were raised."""

import pickle

import pytest

from planner.errors import BoundError, DecouplingError, RangeError, RankError
from sim.errors import SimulationError, UsageError, exit_code, one_line


@pytest.mark.parametrize(
    "error",
    [
        RangeError("phi_1", 0.5, -0.45, 0.45, 12),
        RankError((0.0, 1.0), 2, ["y"]),
        DecouplingError("g1_3", "g1_1"),
        BoundError("too narrow"),
        SimulationError("diverged", "t = 1 s", "step less"),
        UsageError("bad", "--set", "give another"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_an_error_survives_the_way_between_processes(error):
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert vars(again) == vars(error)
    assert one_line(again) == one_line(error)
    assert exit_code(again) == exit_code(error)
