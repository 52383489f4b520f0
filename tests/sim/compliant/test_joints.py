"""Parts over an increment: servos that lag, backlash between stops, feet that slip."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.compliant.increment import _loosened, _slip, _spring

LOADED = 0.01  # of the weight, from which on a foot stands
STOP_STIFFNESS = 5e3  # [N m/rad]; stiffness at the ends of backlash

H = np.array([0.05])  # of the increment [s]


def joints(*values):
    """Of one robot with one foot, (1, 1, J)."""
    return np.array([[values]], dtype=float)


@pytest.mark.parametrize("torque", [0.0, 0.3])
def test_a_servo_lags_behind_its_command_as_a_spring_and_a_damper_do(torque):
    robots = SimpleNamespace(
        stiffness=joints(8.0, 20.0),
        damping=joints(0.2, 3.0),
        offset=joints(0.0, 0.02),
    )
    angles, begin, end = joints(0.1, -0.2), joints(0.12, -0.1), joints(0.3, -0.3)
    found = _spring(robots, SimpleNamespace(angles=angles), begin, end, H)
    came = found.free + found.yield_ * torque

    def rate(t, angle):
        command = begin + (end - begin) * t / H[0] + robots.offset
        return (
            (robots.stiffness * (command - angle) + torque) / robots.damping
        ).ravel()

    true = solve_ivp(rate, (0.0, H[0]), angles.ravel(), rtol=1e-10, atol=1e-12)
    assert came.ravel() == pytest.approx(true.y[:, -1], abs=1e-8)
    # the share of the way to rest, where the command stays
    rest = _spring(robots, SimpleNamespace(angles=angles), end, end, H)
    way = end + robots.offset - angles
    assert rest.free == pytest.approx(angles + rest.share * way)


def loosened(torque, loose=0.0):
    """Joints without backlash and with it."""
    robots = SimpleNamespace(slack=joints(0.0, 0.02, 0.02), rub=joints(2.0, 2.0, 4.0))
    state = SimpleNamespace(loose=joints(0.0, loose, loose))
    return _loosened(robots, state, joints(*[torque] * 3), H)


def test_between_its_stops_only_rubbing_resists_a_joint_and_none_has_no_backlash():
    found, slope = loosened(0.2)
    assert found == pytest.approx(joints(0.0, 0.2 * 0.05 / 2, 0.2 * 0.05 / 4))
    assert slope == pytest.approx(joints(0.0, 0.05 / 2, 0.05 / 4))


@pytest.mark.parametrize("sign", [-1, 1])
def test_at_a_stop_the_rest_of_the_torque_is_against_it(sign):
    found, slope = loosened(5.0 * sign, -0.005 * sign)
    rest = 5.0 - (0.01 + 0.005) * joints(2.0, 4.0) / 0.05  # less what rubbed
    assert found[..., 0] == 0.0
    assert found[..., 1:] == pytest.approx(sign * (0.01 + rest / STOP_STIFFNESS))
    assert slope == pytest.approx(joints(0.0, 1.0, 1.0) / STOP_STIFFNESS)


@pytest.mark.parametrize("torque", [-3.0, -0.2, 0.1, 2.0])
def test_the_slope_is_that_of_the_angle_over_the_torque(torque):
    (above, slope), (below, _) = loosened(torque + 1e-6), loosened(torque - 1e-6)
    assert slope == pytest.approx((above - below) / 2e-6, rel=1e-4, abs=1e-9)


def test_a_foot_slips_as_its_points_do_by_their_loads_while_it_stands():
    """By half as much where it only lands, and not at all where it carries nothing."""
    weight = np.array([10.0])
    little, enough = 0.49 * LOADED * weight[0], 0.51 * LOADED * weight[0]  # at each
    after, before = np.zeros((2, 1, 5, 2, 3))  # forces on points of five feet
    after[0, :, :, 2] = [
        [3.0, 1.0],
        [3.0, 1.0],
        [-1.0, 0.0],
        [little] * 2,
        [enough] * 2,
    ]
    before[0, :, :, 2] = [
        [2.0, 0.0],
        [0.0, 0.0],
        [4.0, 4.0],
        [little] * 2,
        [enough] * 2,
    ]
    moved = np.zeros((1, 5, 2, 2))
    moved[..., 0, :], moved[..., 1, :] = [0.003, 0.004], [0.0, -0.009]
    found = _slip(SimpleNamespace(weight=weight), before, after, moved)
    whole = (3.0 * 0.005 + 1.0 * 0.009) / 4
    assert found == pytest.approx(np.array([[whole, whole / 2, 0.0, 0.0, 0.007]]))
