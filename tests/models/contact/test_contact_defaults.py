"""What touches the floor, and what contact is where nothing more is said of it."""

import mujoco
import numpy as np
import pytest

from models.contact.dissipation import _Problem
from models.contact.kinematics import Core, find_sole

FEET = """<mujoco><worldbody><body><freejoint/>
<geom name="a" size="0.01" pos="0.1 0 0"/><geom name="b" size="0.01" pos="0 0 {high}"/>
</body></worldbody></mujoco>"""


@pytest.mark.parametrize(("high", "touching"), [(0.9e-4, 2), (1.1e-4, 1)])
def test_parts_touch_that_are_lowest_within_a_tenth_of_a_millimetre(high, touching):
    model = mujoco.MjModel.from_xml_string(FEET.format(high=high))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert len(find_sole(model, data, ("a", "b")).geoms) == touching


def test_corners_of_which_nothing_is_said_are_sharp():
    assert Core(np.zeros((1, 3))).radius == 0.0


def test_dissipation_is_that_of_coulomb_s_law_unless_it_is_smoothed():
    feet, loads = (
        np.array([[[0.1, 0.2], [0.3, -0.1], [-0.2, 0.1]]]),
        np.full((1, 3), 2.0),
    )
    rates = np.zeros_like(feet)
    rates[..., 0] = (3.0, 0.0, -1.0)
    power = _Problem(feet, rates, loads, None).dissipation(np.zeros((1, 3)))
    assert power == pytest.approx([2.0 * (3.0 + 0.0 + 1.0)])
