"""Commands that allow for dead bands: to which side, how far, and on whole counts."""

import numpy as np
import pytest

from sim.drive.dead_bands import DeadBands
from sim.drive.drive import Drive
from sim.preparation.setup import prepare

BAND = 0.0087


@pytest.fixture
def bands(scenario):
    def make(**given):
        return DeadBands(prepare(scenario(robot="hexapod-classroom", **given)))

    return make


def test_swings_are_shifted_along_their_group_s_motion_toward_its_torque(bands):
    allowed = bands(assumed_dead_band=BAND, resolution=0.0)
    robot = allowed.setup.robot
    joints = robot.card.joints
    swings = [joints.index(joint) for joint in robot.swing_joints]
    lifts = [joints.index(joint) for joint in robot.lift_joints]
    gain, first = robot.swing_gain, robot.group_of_leg == 0
    torque = np.zeros((2, 12))
    torque[0, swings] = np.where(first, gain, -gain)  # Q of +, and of -
    torque[0, swings[int(np.flatnonzero(first)[0])]] *= -0.1  # one against the others
    torque[0, lifts] = [1, -1, 1, 1, -1, 1]
    shifts = allowed.shifts(torque)
    assert shifts[0, swings] == pytest.approx(
        np.sign(gain) * np.where(first, 1, -1) * BAND / 2
    )
    assert shifts[0, lifts] == pytest.approx(torque[0, lifts] * BAND / 2)
    assert (shifts[1] == 0).all()


def test_bands_that_are_nearly_a_count_are_shifted_by_whole_counts(bands):
    allowed = bands(assumed_dead_band=BAND)  # counts of 0.00898
    robot, resolution = allowed.setup.robot, allowed.setup.servo.resolution
    joints = robot.card.joints
    swings = [joints.index(joint) for joint in robot.swing_joints]
    pushed = allowed.shifts(np.ones((1, 12)) * 0.1)[0, swings]
    counts = pushed / resolution
    assert np.abs(counts - np.round(counts)).max() < 0.03


def test_what_is_assumed_is_what_is_simulated_unless_it_is_given(bands):
    assert (bands(dead_band=BAND).half == BAND / 2).all()
    assert (bands(dead_band=BAND, assumed_dead_band=0.0).half == 0).all()
    assert not Drive(bands().setup).allows_for_bands
    assert not Drive(bands(dead_band=BAND).setup.as_planned).allows_for_bands
