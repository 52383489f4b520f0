"""Springs under the feet, as the engine has them for feet that just touch."""

import numpy as np
import pytest

from models.contact.kinematics import Kinematics
from models.contact.sliding import Ground
from sim.preparation.setup import prepare

RAISED = 'rgba="0.80 0.27 0.24 1" name="foot_3"'


def grounds(robot, scenario):
    setup = prepare(scenario(robot=str(robot.path)))
    return setup.robot, Ground.of(setup.robot, setup.model)


def test_a_foot_that_hangs_above_the_floor_is_sunk_until_it_touches(edited, scenario):
    """It hangs by less than the floor gives way, so the robot stands on it."""
    level = f'pos="0.105 0 -0.052" {RAISED}'
    _, even = grounds(edited(), scenario)
    robot, ground = grounds(
        edited(level, level.replace("-0.052", "-0.05198")), scenario
    )
    height = Kinematics(robot).standing.height
    assert height.argmax() == 2
    assert np.ptp(height) == pytest.approx(2e-5, abs=1e-9)
    assert ground.contact[2] == pytest.approx(even.contact[2], rel=1e-3)
