"""Command k is given at the first physics step at or after k / rate."""

import numpy as np
import pytest

from sim.motion.schedule import command_at, step_of


@pytest.mark.parametrize("rate", [50.0, 60.0, 333.0, 1000.0])
@pytest.mark.parametrize("timestep", [1e-3, 5e-4])
def test_commands_begin_at_the_first_step_that_is_not_before_them(rate, timestep):
    commands = np.arange(2000)
    steps = step_of(commands, rate * timestep)
    early = 1e-8 * timestep  # for rounding
    assert (steps * timestep >= commands / rate - early).all()
    assert ((steps - 1) * timestep < commands / rate).all()
    assert (command_at(steps, rate * timestep) == commands).all()
