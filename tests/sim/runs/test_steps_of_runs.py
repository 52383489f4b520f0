"""A run has a command for each step of its physics, and the settings of a scenario."""

import re

import numpy as np
import pytest

from sim.errors import UsageError
from sim.runs.run import read_run
from tests.finished_runs import reset, sealed


@pytest.mark.physics
@pytest.mark.parametrize("times", [2, 100])
def test_more_commands_than_steps_are_refused(folder, times):
    """A small file may hold millions, which exports would write and play."""
    path = folder / "commands.npz"
    with np.load(path) as file:
        time, ctrl = file["time"], file["ctrl"]
    rows = times * len(time)
    even = np.linspace(0.0, time[-1] + time[1], rows + 1)[:-1]
    np.savez_compressed(path, time=even, ctrl=np.resize(ctrl, (rows, ctrl.shape[1])))
    sealed(folder)
    with pytest.raises(UsageError, match=r"commands\.npz has not the times of flows"):
        read_run(folder)


@pytest.mark.physics
def test_settings_that_no_scenario_has_are_refused_by_all_that_read_a_run(folder):
    reset(
        folder,
        lambda text: re.sub("^friction = .*", "friction = nan", text, flags=re.M),
    )
    with pytest.raises(UsageError, match="friction = nan is not allowed"):
        read_run(folder)
