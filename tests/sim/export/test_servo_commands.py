"""Commands at the servos' rate: taken out of a walk, and held in the physics."""

import numpy as np
import pytest

from sim.errors import UsageError
from sim.export.servo_commands import ServoCommands, taken

TIMESTEP = 0.0005
ACTUATORS = np.array([2, 0])
JOINTS = ("lift", "swing")


def rows(steps, seed=0):
    return np.random.default_rng(seed).normal(size=(steps, 4))


@pytest.mark.parametrize("rate", [7.0, 50.0, 60.0, 333.0, 2000.0])
def test_each_command_is_the_row_at_or_after_its_time(rate):
    ctrl = rows(3001)
    commands = taken(ctrl, JOINTS, ACTUATORS, rate, TIMESTEP)
    last = int(np.floor(3000 * TIMESTEP * rate + 1e-6))
    first = [int(np.ceil(k / rate / TIMESTEP - 1e-6)) for k in range(last + 1)]
    assert (commands.angles == ctrl[first][:, ACTUATORS]).all()
    assert commands.time == pytest.approx(np.arange(last + 1) / rate)


@pytest.mark.parametrize("rate", [7.0, 60.0, 333.0, 2000.0])
def test_commands_that_are_held_are_taken_again_unchanged(rate):
    angles = rows(40)[:, :2]
    commands = ServoCommands(JOINTS, rate, angles)
    steps = int(40 / rate / TIMESTEP)
    held = np.concatenate(list(commands.rows(steps, TIMESTEP)))
    assert held.shape == (steps, 2)
    again = taken(held, JOINTS, np.array([0, 1]), rate, TIMESTEP)
    assert (again.angles == angles[: len(again.angles)]).all()
    assert len(again.angles) >= 39


def test_the_last_command_holds_to_the_end():
    commands = ServoCommands(JOINTS, 50.0, rows(3)[:, :2])
    held = np.concatenate(list(commands.rows(9000, TIMESTEP)))
    assert (held[80:] == commands.angles[2]).all()


def test_interpolated_commands_are_lines_between_those_that_are_given():
    commands = ServoCommands(JOINTS, 50.0, rows(4)[:, :2])
    given = commands.rows(9000, TIMESTEP, interpolated=True)
    ctrl = np.concatenate(list(given))
    assert ctrl[:121:40] == pytest.approx(commands.angles)  # every 20 ms
    between = (commands.angles[0] + 3 * commands.angles[1]) / 4
    assert ctrl[30] == pytest.approx(between)
    assert (ctrl[120:] == commands.angles[3]).all()


def test_more_commands_than_physics_steps_are_refused():
    with pytest.raises(UsageError, match="give at most 2000"):
        taken(rows(10), JOINTS, ACTUATORS, 2001.0, TIMESTEP)


@pytest.mark.parametrize(
    ("rate", "angles"),
    [(0.0, np.zeros((3, 2))), (50.0, np.zeros((3, 3))), (50.0, np.zeros((0, 2)))],
)
def test_commands_that_contradict_themselves_are_refused(rate, angles):
    with pytest.raises(ValueError, match="rate|shape|no command"):
        ServoCommands(JOINTS, rate, angles)
