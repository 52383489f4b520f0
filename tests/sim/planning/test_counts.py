"""Strokes that end on the counts of servos, whatever the gains of their legs."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim.planning.open_loop import _count


def setup_with(gain):
    """A setup of one group of two legs whose range, 0.105 each way, is off counts."""
    robot = SimpleNamespace(
        group_of_leg=np.array([0, 0]),
        swing_gain=np.array([1.0, gain]),
        groups=("1",),
    )
    equations = SimpleNamespace(limits={"phi_1": (-0.105, 0.105)})
    servo = SimpleNamespace(resolution=0.01)
    return SimpleNamespace(robot=robot, servo=servo, equations=equations)


@pytest.mark.parametrize(("gain", "reached"), [(1.0, 0.01), (0.5, 0.02), (-0.75, 0.0)])
def test_all_legs_of_a_group_are_on_counts_where_their_gains_allow_it(gain, reached):
    assert _count(setup_with(gain), 0, 0.013) == pytest.approx(reached)


@pytest.mark.parametrize("gain", [1.0, -1.0, 2.0])
@pytest.mark.parametrize("angle", [-0.5, 0.109, 0.135])
def test_strokes_that_lead_beyond_the_range_end_on_its_last_count(gain, angle):
    last = np.sign(angle) * 0.1
    assert _count(setup_with(gain), 0, angle) == pytest.approx(last)
