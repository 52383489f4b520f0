"""Shipped robots with other numbers keep what the numbers do not touch."""

import numpy as np
import pytest

from models.errors import ModelError
from models.library import load
from models.morphology.mjcf import legs_on_a_circle, legs_towards_pivots
from models.morphology.shipped import MORPHOLOGIES, geometry_of, reshaped
from models.motion.robot_equations import equations


@pytest.mark.parametrize("shape", MORPHOLOGIES, ids=lambda shape: shape.name)
def test_without_other_numbers_a_shape_is_the_shipped_one(shape):
    assert reshaped(shape.name, {}) == shape
    assert reshaped(shape.name, geometry_of(shape.name)) == shape


@pytest.mark.parametrize("kappa", [0.4, 0.7])
def test_stride_and_yaw_gain_follow_kappa(kappa):
    robot = load("hexapod", geometry={"kappa": kappa})
    forward, left, yaw = equations(robot).twists["g1_1"]
    assert forward == pytest.approx(kappa * 0.0675)  # the pivot's distance
    assert left == pytest.approx(0, abs=1e-9)
    assert yaw == pytest.approx(kappa)


def test_masses_and_heights_are_those_given():
    robot = load("hexapod", geometry={"body_mass": 2.0, "hip_height": 0.07})
    plain = load("hexapod")
    assert robot.model.body("torso").mass[0] == 2.0
    assert robot.model.body("torso").pos[2] == 0.07
    assert robot.card == plain.card
    assert robot.model.nu == plain.model.nu


def test_unknown_numbers_are_refused_with_those_known():
    with pytest.raises(ModelError, match="geometry.kapa is unknown; did you mean 'kap"):
        load("hexapod", geometry={"kapa": 0.5})
    with pytest.raises(ModelError, match="body_mass = -1.0 is not above 0"):
        load("hexapod", geometry={"body_mass": -1.0})
    for sign in (1, -1):
        with pytest.raises(ModelError, match="kappa = .*561.0 is beyond 560"):
            load("hexapod", geometry={"kappa": sign * 561.0})


def test_a_robot_of_ones_own_has_no_such_numbers(edited):
    path = str(edited().path)
    with pytest.raises(ModelError, match="change its file"):
        load(path, geometry={"kappa": 0.5})


def test_lines_of_legs_meet_at_a_pivot_anywhere_a_part_of_the_way_behind_the_foot():
    """And a radial leg stands in line with its pivot, wherever that is."""
    pivot, foot = np.array([0.3, -0.4]), np.array([0.5, 0.1])
    (leg,) = legs_towards_pivots({1: tuple(foot)}, {1: tuple(pivot)}, 0.25).values()
    assert leg.foot == tuple(foot)
    assert np.subtract(foot, leg.hip) == pytest.approx(0.25 * (foot - pivot))
    (leg,) = legs_on_a_circle({1: 50.0}, 0.1, 0.07, {1: tuple(pivot)}).values()
    hip = 0.1 * np.array([np.cos(np.radians(50)), np.sin(np.radians(50))])
    assert leg.hip == pytest.approx(hip)
    out, along = np.subtract(leg.foot, hip), hip - pivot
    assert np.hypot(*out) == pytest.approx(0.07)
    assert out[0] * along[1] == pytest.approx(out[1] * along[0])
    assert out @ along > 0
