"""How high feet can be raised, and the angle that does it."""

import numpy as np
import pytest

from models.contact.kinematics import Kinematics
from models.contact.lifting import Lifting
from sim.errors import UsageError
from sim.preparation.setup import prepare


@pytest.fixture(scope="module")
def lifting(hexapod):
    return Lifting(Kinematics(hexapod))


def test_a_height_is_reached_by_every_foot(hexapod, lifting):
    angle = lifting.angle(0.02)
    height = Kinematics(hexapod).stance(np.zeros(2), np.full(2, angle)).height
    # a table of 0.6 mrad, whose chords are off by a leg's length * step^2 / 8 at most
    assert height.min() == pytest.approx(0.02, abs=1e-8)


def test_the_joints_go_no_farther_than_their_range(lifting):
    assert lifting.farthest == pytest.approx(0.6)
    assert lifting.highest == lifting.rise(np.array(0.6)).min()


def test_a_lift_height_beyond_the_range_is_refused_with_the_achievable_one(
    scenario, lifting
):
    # the foot of a leg of 0.105 m would go higher, were the joint not at its end
    beyond = lifting.rise(np.array(0.7)).min()
    with pytest.raises(UsageError, match="lift_height = .* lift joints: hexapod; give"):
        prepare(scenario(lift_height=float(beyond)))
    setup = prepare(scenario(lift_height=float(f"{lifting.highest - 5e-5:.4f}")))
    assert setup.limits.lift_angle == pytest.approx(0.6, abs=2e-3)
