"""How high feet can be raised, and the angle that does it."""

import numpy as np
import pytest

from models.contact.kinematics import Kinematics
from sim.errors import UsageError
from sim.preparation.setup import prepare


@pytest.fixture(scope="module")
def lifting(hexapod):
    return Kinematics(hexapod)


def test_a_height_is_reached_by_every_foot(hexapod, lifting):
    angle = lifting.lift_to(0.02)
    height = Kinematics(hexapod).stance(np.zeros(2), np.full(2, angle)).height
    # a table of 0.6 mrad, whose chords are off by a leg's length * step^2 / 8 at most
    assert height.min() == pytest.approx(0.02, abs=1e-8)


def test_the_joints_go_no_farther_than_their_range(lifting):
    assert lifting.farthest_lift == pytest.approx(0.6)
    assert lifting.highest == lifting.rise(np.array(0.6)).min()


def test_the_joint_that_goes_least_far_bounds_all_of_them(edited):
    joint = '<joint class="lift" name="lift_3"/>'
    robot = edited(joint, joint.replace("/>", ' range="-0.1 0.4"/>'))
    assert Kinematics(robot).farthest_lift == pytest.approx(0.4)


def test_the_foot_that_rises_least_is_the_height_of_all(edited):
    """A leg of 0.08 m instead of 0.105 m is raised by less at the same angle."""
    long = (
        '<geom class="foot" pos="0.105 0 -0.052" rgba="0.80 0.27 0.24 1" name="foot_3"'
    )
    lifting = Kinematics(edited(long, long.replace("0.105", "0.080")))
    rises = lifting.rise(np.array(0.6))
    assert rises.argmin() == 2
    assert np.ptp(rises) > 0.01
    assert lifting.highest == pytest.approx(rises[2], abs=1e-12)
    angle = lifting.lift_to(0.02)
    assert lifting.rise(np.array(angle))[2] == pytest.approx(0.02, abs=1e-8)


def test_a_lift_height_beyond_the_range_is_refused_with_the_achievable_one(
    scenario, lifting
):
    # the foot of a leg of 0.105 m would go higher, were the joint not at its end
    beyond = lifting.rise(np.array(0.7)).min()
    with pytest.raises(UsageError, match="lift_height = .* lift joints: hexapod; give"):
        prepare(scenario(lift_height=float(beyond)))
    setup = prepare(scenario(lift_height=float(f"{lifting.highest - 5e-5:.4f}")))
    assert setup.limits.lift_angle == pytest.approx(0.6, abs=2e-3)
