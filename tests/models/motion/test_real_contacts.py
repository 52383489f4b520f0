"""Fields of the real contacts: polynomials as good as what they are fitted to."""

import numpy as np
import pytest

from models.contact.kinematics import Kinematics
from models.contact.sliding import Ground
from models.library import load
from models.motion.real_contacts import (
    contact_equations,
    contact_fields,
)
from models.motion.robot_equations import equations
from models.motion.strokes import Strokes
from models.motion.twists import QuasiStaticTwists
from planner.controllability.gaits import gait_controllability
from planner.extension.bracket_fields import hall_fields
from planner.planning.rollouts import play
from planner.systems.flows import Flow

LIFTED = ("g1_1", "g2_2")


def fitted(name):
    robot = load(name)
    kinematics = Kinematics(robot)
    twists = QuasiStaticTwists(kinematics, Ground.of(robot, robot.model))
    described = equations(robot)
    names = [e for e in described.elements if e in described.swings]
    fields = contact_fields(described, robot.groups, twists, names)
    return robot, kinematics, twists, described, fields


@pytest.mark.parametrize(
    ("name", "names", "accuracy"),
    [  # measured: 9e-10, 8e-9, 2e-6; the quadruped's feet let go when it turns
        ("hexapod", LIFTED, 3e-9),
        ("hexapod-radial", LIFTED, 3e-8),
        ("octopod", LIFTED, 6e-6),
        ("quadruped", ("g1234_forward",), 1e-9),
    ],
)
def test_polynomials_are_the_quasi_static_twist_over_the_joint_range(
    name, names, accuracy
):
    robot, _, twists, described, fields = fitted(name)
    rng = np.random.default_rng(7)
    for field in (fields[n] for n in names):
        shares = rng.uniform(size=(100, len(field.axes)))
        low, high = field.spans.T
        ways = low + shares * (high - low)
        swing = ways @ np.linalg.pinv(field.axes).T
        rates = np.broadcast_to(np.array(field.direction), swing.shape)
        gap = np.abs(field(swing) - twists(field.stratum, swing, rates)).max()
        assert gap < accuracy
        assert max(field.error) < accuracy


def test_accuracy_is_told_where_feet_let_go():
    fields = fitted("hexapod-parallel")[-1]
    assert max(fields["g1_1"].error) > 1e-3  # [m/rad]; a kink no polynomial follows


def test_symbolic_fields_are_the_polynomials():
    robot, _, _, described, fields = fitted("hexapod")
    real = contact_equations(described, fields)
    x = np.array([0.1, -0.2, 0.7, 0.3, -0.4, 0.0, 0.0])
    velocity = real.system.compiled("g1_1").velocity(x)
    forward, left, yaw = fields["g1_1"](x[None, 3:5])[0]
    cos, sin = np.cos(0.7), np.sin(0.7)
    expected = [forward * cos - left * sin, forward * sin + left * cos, yaw, 1, 0, 0, 0]
    assert velocity == pytest.approx(expected, abs=1e-12)


def test_an_uncentred_stroke_goes_sideways_as_constant_fields_do_not():
    fields = fitted("hexapod")[-1]
    left = fields["g1_1"](np.array([[-0.45, 0.0], [0.0, 0.0], [0.45, 0.0]]))[:, 1]
    assert abs(left[1]) < 1e-6
    assert left[2] == pytest.approx(-left[0], abs=1e-6)
    assert abs(left[2]) == pytest.approx(0.020, abs=0.001)  # measured [m/rad]


def test_flows_of_real_fields_go_where_the_prediction_goes():
    robot, kinematics, twists, described, fields = fitted("hexapod")
    real = contact_equations(described, fields).system
    flows = [Flow("1", "g1_1", 0.4), Flow("2", "g2_2", -0.3), Flow("1", "g1_1", -0.7)]
    strokes = Strokes(
        strata=("1", "2", "1"),
        begin=np.array([[0.0, 0.0], [0.4, 0.0], [0.4, -0.3]]),
        change=np.array([[0.4, 0.0], [0.0, -0.3], [-0.7, 0.0]]),
    )
    predicted = strokes.travel(twists, kinematics).pose(np.array([3.0]))[0]
    end = play(real, flows, np.zeros(real.dimension))[-1]
    assert end[:3] == pytest.approx(predicted, abs=1e-8)  # 1.4 rad of 9e-10 m/rad


def test_real_fields_have_brackets_and_span_what_a_gait_needs():
    robot, _, _, described, fields = fitted("hexapod")
    real = contact_equations(described, fields).system
    gait, start = robot.card.gait, np.zeros(real.dimension)
    assert gait_controllability(real, gait, start).controllable
    sideways = hall_fields(real, LIFTED, max_degree=2)
    assert [str(e) for e in sideways.elements] == ["1", "2", "[1,2]"]
