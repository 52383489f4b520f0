"""Twist models by hand: sums of fields, polynomials of legs' angles, and refusals."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from numpy.polynomial import Polynomial, chebyshev

from models.contact.kinematics import Kinematics
from models.errors import MeasurementError, ModelError
from models.library import load
from models.motion.equations_of_motion import Swing, _exact, walking_system
from models.motion.real_contacts import (
    ACROSS,
    STROKE_NODES,
    ContactField,
    _fit,
    _horner,
)
from models.motion.robot_equations import Equations, _elements, _reason, equations
from models.motion.twists import (
    FailedField,
    IdealTwists,
    IdentifiedTwists,
    MeasuredField,
)

STRAIGHT = 1e-3  # rad of yaw while the body moves by the size of its stance
ROUNDING_ANGLE = 1e-6  # [rad] by which angles may lie beyond the reach

SWING = np.array([[0.1, -0.2], [0.5, 0.3], [-0.7, 0.0]])
RATES = np.array([[1.0, 0.5], [-2.0, 0.0], [0.0, 0.3]])


def measured(direction, stratum="12", reach=np.inf):
    parts = Polynomial([0.1, 2.0]), Polynomial([0.0, 1.0, 3.0]), Polynomial([0.5])
    return MeasuredField(stratum, direction, 0.4, parts, 0.0, reach)


def test_a_measured_field_is_constant_beyond_its_swing():
    field = measured((1.0, 0.0))
    ways = np.array([-0.9, -0.4, 0.0, 0.3, 0.4, 2.0])
    inside = np.clip(ways, -0.4, 0.4)
    expected = np.stack([0.1 + 2 * inside, inside + 3 * inside**2, 0.5 + 0 * ways], 1)
    assert field(ways) == pytest.approx(expected)


def test_identified_twists_add_up_by_what_groups_do():
    one, other = measured((1.0, 0.0)), measured((0.5, 2.0))
    model = IdentifiedTwists({"a": one, "b": other, "c": measured((0, 1), "1")})
    # (1, 0) u + (0.5, 2) w are the rates, and likewise the ways
    w = RATES[:, 1] / 2
    u, far = RATES[:, 0] - w / 2, SWING[:, 1] / 2
    near = SWING[:, 0] - far / 2
    expected = u[:, None] * one(near) + w[:, None] * other(far)
    assert model("12", SWING, RATES) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("beyond", "rate", "refused"),
    [(0.9, 1.0, False), (1.1, 1.0, True), (2.0, 0.0, False), (-1.1, -1.0, True)],
)
def test_fields_serve_as_far_as_they_were_confirmed(beyond, rate, refused):
    far = 0.6 + abs(beyond) * ROUNDING_ANGLE
    swing = np.array([[np.sign(beyond) * far, 0.0]])
    model = IdentifiedTwists({"a": measured((1.0, 0.0), reach=0.6)})
    if refused:
        told = "field a swings to 0.6 rad, but is confirmed to 0.6 rad either way; plan"
        with pytest.raises(MeasurementError, match=told):
            model("12", swing, np.array([[rate, 0.0]]))
    else:
        assert model("12", swing, np.array([[rate, 0.0]])).shape == (1, 3)


def test_fields_that_could_not_be_measured_are_refused_on_their_stratum_alone():
    failed = {"b": FailedField("1", "it fell")}
    model = IdentifiedTwists({"a": measured((1.0, 0.0))}, failed)
    assert model("12", SWING[:1], np.array([[1.0, 0.0]])).shape == (1, 3)
    with pytest.raises(MeasurementError, match="b could not be measured: it fell; t"):
        model("1", SWING, RATES)


def test_ideal_twists_add_up_by_the_strides_of_fields():
    described = equations(load("hexapod"))
    found = IdealTwists(described)("12", SWING, RATES)
    expected = sum(
        RATES[:, k, None] * np.array(described.twists[f"g12_{k + 1}"]) for k in (0, 1)
    )
    assert found == pytest.approx(expected)
    alone = IdealTwists(described)("1", SWING, RATES)
    assert alone == pytest.approx(RATES[:, :1] * described.twists["g1_1"])


SPANS = np.array([[-0.4, 0.6], [0.1, 0.9]])


def polynomial(seed=1, shape=(3, 4, 3)):
    coefficients = np.random.default_rng(seed).normal(size=shape)
    axes = np.array([[1.0, 0.5], [0.0, 2.0]])
    return ContactField("1", (1.0, 0.0), axes, SPANS, coefficients, (0.0,) * 3)


def test_a_contact_field_is_its_chebyshev_series_and_its_expressions_are_the_same():
    field = polynomial()
    ways = SWING @ field.axes.T
    scaled = (2 * ways - SPANS.sum(axis=1)) / np.ptp(SPANS, axis=1)
    basis = [
        chebyshev.chebvander(u, n - 1) for u, n in zip(scaled.T, (4, 3), strict=True)
    ]
    expected = np.einsum("cij,ni,nj->nc", field.coefficients, *basis)
    assert field(SWING) == pytest.approx(expected)
    angles = sp.symbols("a b")
    written = sp.lambdify(angles, field.expressions(angles))
    assert np.array([written(*row) for row in SWING]) == pytest.approx(expected)


def test_series_with_parts_that_are_zero_are_shorter_to_write():
    u, v = sp.symbols("u v")
    found = _horner(np.array([[1.0, 2.0], [0.0, 0.0], [3.0, 0.0]]), [u, v])
    expected = 1 + 2 * v + 3 * (2 * u**2 - 1)
    assert sp.expand(found - expected) == 0
    assert _horner(np.array(2.5), []) == 2.5


def twists_of(function):
    return lambda stratum, swing, rates: function(swing) * rates[:, :1]


@pytest.mark.parametrize("direction", [(1.0, 0.0), (2.0, 0.0)])
def test_a_twist_that_is_a_polynomial_is_fitted_exactly(direction):
    def twist(swing):
        a, b = swing.T
        return np.stack([1 + a**12, 0.2 * b**4 * a, np.full(len(a), 1e-10)], axis=1)

    field = _fit("1", direction, SPANS, twists_of(twist), 3e-9)
    swing = np.random.default_rng(2).uniform(*SPANS.T, size=(50, 2))
    expected = twist(swing) * direction[0]
    assert field(swing)[:, :2] == pytest.approx(expected[:, :2], abs=1e-7)
    assert field.coefficients.shape[1:] == (13, 5)
    assert (STROKE_NODES, ACROSS) == (13, 5)
    assert not field.coefficients[2].any()  # which is small enough to be dropped
    assert field.error == pytest.approx(
        np.abs(field(swing) - expected).max(0), abs=1e-7
    )
    assert field.error[2] == pytest.approx(1e-10 * direction[0])


def test_degrees_that_a_twist_does_not_have_are_left_out():
    def twist(swing):
        return np.stack([swing[:, 0] ** 2, swing[:, 1], 1 + 0 * swing[:, 0]], axis=1)

    field = _fit("1", (1.0, 0.0), SPANS, twists_of(twist), 3e-9)
    assert field.coefficients.shape == (3, 3, 2)
    still = _fit(
        "1", (1.0, 0.0), SPANS, twists_of(lambda s: np.zeros((len(s), 3))), 3e-9
    )
    assert still.coefficients.shape == (3, 1, 1)


def test_what_no_polynomial_follows_is_told_as_the_error():
    def twist(swing):
        return np.stack([np.abs(swing[:, 0]), *np.zeros((2, len(swing)))], axis=1)

    field = _fit("1", (1.0, 0.0), SPANS, twists_of(twist), 3e-9)
    ways = np.linspace(-0.4, 0.6, 5001)
    swing = np.stack([ways, np.full_like(ways, 0.5)], axis=1)
    worst = np.abs(field(swing) - twist(swing)).max()
    assert 0.3 * worst < field.error[0] <= worst * (1 + 1e-9)


def test_of_three_groups_only_the_way_along_the_stroke_counts():
    spans = np.array([[-0.4, 0.6], [-0.9, 0.3], [-0.1, 0.1]])

    def twist(swing):
        return np.stack([swing[:, 0] ** 2, swing[:, 1], swing[:, 2]], axis=1)

    field = _fit("1", (1.0, 0.5, 0.0), spans, twists_of(twist), 3e-9)
    assert field.axes == pytest.approx(np.array([[1.0, 0.5, 0.0]]) / 1.25)
    assert field.spans == pytest.approx(np.array([[-0.4, 0.4]]))  # the nearest end
    way = np.array([[-0.4], [0.1], [0.3]])
    found = field(way * [1.0, 0.5, 0.0])
    expected = np.concatenate([way**2, 0.5 * way, 0 * way], axis=1)
    assert found == pytest.approx(expected, abs=1e-9)


def described(one, other):
    return SimpleNamespace(
        twists={"a": one, "b": other}, elements=("a", "b", "c"), swings={}
    )


@pytest.mark.parametrize(
    ("one", "other", "reason"),
    [
        ((1.0, 0.0, 0.0), (0.5, 0.0, 0.0), "neither of its two strokes turns the body"),
        ((1.0, 0.0, 0.9), (0.5, 0.0, 0.4), "neither of its two strokes turns"),
        ((1.0, 0.0, 1.1), (0.5, 0.0, 0.4), "its strokes are short: even "),
        (
            (0.02, -0.01, 0.5), (-0.03, 0.01, -1.0),
            "nearly the same point, (0.020, 0.040) m, where the legs of both groups, "
            "produced inward, meet: their pivots are 14.1 mm apart",
        ),
        ((0.02, -0.01, 0.5), (0.04, -0.02, -1.0), "its strokes are short: even "),
    ],
)  # fmt: skip
def test_why_a_robot_cannot_go_everywhere(hexapod, one, other, reason):
    """Where the pivots are near, or yaws in parts of what counts as straight."""
    if one[0] == 1.0:
        unit = STRAIGHT / Kinematics(hexapod).reach
        one, other = (
            (ahead, left, yaw * ahead * unit) for ahead, left, yaw in (one, other)
        )
    assert reason in _reason(hexapod, described(one, other))


def test_a_field_s_stroke_is_as_long_as_the_first_joint_allows():
    found = Equations(
        None, (), {"a": (3.0, 4.0, 9.0)}, {"a": (1.0, -0.5, 0.0), "b": (0.0, 0.0, 2.0)},
        "centred", None, {"phi_1": (-0.3, 0.5), "phi_2": (-0.1, 0.2), "phi_3": (0, 3)},
    )  # fmt: skip
    assert found.strokes == pytest.approx({"a": 0.6, "b": 1.5})
    assert found.stride("a") == 5.0


def test_steering_needs_two_swings_of_standing_legs_and_every_group_lifted():
    robot = load("hexapod")
    swings = [
        Swing("12", "1", (1.0, 0.0), (1, 0, 0)), Swing("1", "1", (1.0, 0.0), (1, 0, 0)),
        Swing("1", "2", (0.0, 1.0), None), Swing("2", "2", (0.0, 1.0), (1, 0, 0)),
        Swing("2", "1", (1.0, 0.0), None), Swing("12", "2", (0.0, 1.0), (1, 0, 0)),
    ]  # fmt: skip
    assert _elements(robot, tuple(swings), "lifted") == (
        "g1_1", "g2_2", "g1_2", "g2_1", "[g1_1,g2_2]",
    )  # fmt: skip
    assert _elements(robot, tuple(swings), "paper")[:2] == ("g12_1", "g12_2")
    with pytest.raises(ModelError, match="the gait 12 1 12 2 12 has 1: .*let two"):
        _elements(robot, tuple(swings[:3]), "lifted")
    with pytest.raises(ModelError, match="the gait never lifts group 1"):
        _elements(robot, tuple(swings[:4]), "lifted")


@pytest.mark.parametrize(
    ("value", "exact"),
    [(2.0, True), (-3.0, True), (0.5, False), (2.0**52, True), (2.0**53, False)],
)
def test_whole_numbers_are_written_without_a_point(value, exact):
    found = _exact(value)
    assert float(found) == value
    assert found.is_Integer == exact


@pytest.mark.parametrize("length", [0.5, 2.0])
def test_a_trailer_s_axle_follows_its_hitch_without_slipping_aside(length):
    swing = Swing("1", "1", (1.0,), (0.3, 0.2, 0.7))
    system = walking_system(
        ("1",), (("1", "1"),), (swing,), heights=False, trailer=length
    )
    x, y, theta, psi, _ = system.state
    column = system.fields["g1_1"]
    axle = sp.Matrix([x - length * sp.cos(psi), y - length * sp.sin(psi)])
    moved = axle.jacobian(sp.Matrix(system.state)) * column
    aside = -sp.sin(psi) * moved[0] + sp.cos(psi) * moved[1]
    for values in np.random.default_rng(0).uniform(-1, 1, (5, 5)):
        at = dict(zip(system.state, values, strict=True))
        assert float(aside.subs(at)) == pytest.approx(0.0, abs=1e-12)
        cos, sin = np.cos(at[theta]), np.sin(at[theta])
        velocity = [float(column[k].subs(at)) for k in range(3)]
        assert velocity == pytest.approx(
            [0.3 * cos - 0.2 * sin, 0.3 * sin + 0.2 * cos, 0.7]
        )
