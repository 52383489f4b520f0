"""Strokes that end on the counts of servos, whatever the gains of their legs."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim.planning.open_loop import _count


@pytest.mark.parametrize(("gain", "reached"), [(1.0, 0.01), (0.5, 0.02), (-0.75, 0.0)])
def test_all_legs_of_a_group_are_on_counts_where_their_gains_allow_it(gain, reached):
    leg = SimpleNamespace(swing="swing")
    robot = SimpleNamespace(
        group_of_leg=np.array([0, 0]),
        swing_gain=np.array([1.0, gain]),
        groups=("1",),
        leg_cards=(leg, leg),
        standing_angle=lambda joint: 0.0,
    )
    equations = SimpleNamespace(limits={"phi_1": (-1.0, 1.0)})
    servo = SimpleNamespace(resolution=0.01)
    setup = SimpleNamespace(robot=robot, servo=servo, equations=equations)
    assert _count(setup, 0, 0.013) == pytest.approx(reached)
