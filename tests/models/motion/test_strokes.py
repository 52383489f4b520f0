"""Strokes: which moves are, and where they carry the body, against fine steps."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.contact.dissipation import foot_velocities
from models.contact.kinematics import Kinematics
from models.library import load
from models.motion.robot_equations import equations
from models.motion.strokes import Strokes, _Panels

PANEL = 0.05  # [rad]; longest part of a stroke that is one panel of integration
PANEL_NODES = 4  # exact for integrands of degree 7 over a panel

MOVES = [
    ("12", [0.3, 0.0]),
    ("1", [0.0, 0.2]),  # in the air
    ("1", [-0.16, 0.1]),
    ("2", [0.0, 0.0]),
    ("2", [0.1, -0.27]),
]


def test_strokes_are_the_moves_in_which_a_group_swings_that_stands():
    strokes, loaded = Strokes.among(MOVES, ["1", "2"], [0.05, -0.1])
    assert loaded.tolist() == [True, False, True, False, True]
    assert strokes.strata == ("12", "1", "2")
    assert strokes.change.tolist() == [[0.3, 0.0], [-0.16, 0.1], [0.1, -0.27]]
    expected = [[0.05, -0.1], [0.35, 0.1], [0.19, 0.2]]
    assert strokes.begin == pytest.approx(np.array(expected))


def test_no_moves_are_no_strokes():
    strokes, loaded = Strokes.among([], ["1", "2"], [0.0, 0.0])
    assert loaded.size == 0
    travel = strokes.travel(twist, SimpleNamespace())
    assert travel.pose(np.array([0.0, 1.0])).tolist() == [[0.0] * 3] * 2


def twist(stratum, swing, rates):
    """A body that moves as its legs swing, another way on each stratum."""
    own = {"12": 1.0, "1": 0.7, "2": -0.4}[stratum]
    ways = np.stack([np.cos(swing[:, 0]), 0.2 + swing[:, 1], 3 * own - swing[:, 0]], 1)
    return own * ways * (rates[:, :1] - 0.5 * rates[:, 1:])


def poses(strokes, count=400):
    """Poses after each of many fine steps of every stroke, by Runge and Kutta."""
    pose, found = np.zeros(3), [np.zeros(3)]
    for stratum, begin, change in zip(
        strokes.strata, strokes.begin, strokes.change, strict=True
    ):

        def rate(pose, share, stratum=stratum, begin=begin, change=change):
            (body,) = twist(stratum, (begin + share * change)[None], change[None])
            c, s = np.cos(pose[2]), np.sin(pose[2])
            return np.array(
                [c * body[0] - s * body[1], s * body[0] + c * body[1], body[2]]
            )

        h = 1 / count
        for k in range(count):
            a = rate(pose, k * h)
            b = rate(pose + h / 2 * a, (k + 0.5) * h)
            c = rate(pose + h / 2 * b, (k + 0.5) * h)
            pose = pose + h / 6 * (a + 2 * b + 2 * c + rate(pose + h * c, (k + 1) * h))
            found.append(pose)
    return np.array(found)


def test_a_body_goes_where_its_twist_carries_it():
    strokes, _ = Strokes.among(MOVES, ["1", "2"], [0.05, -0.1])
    clock = np.linspace(0, 3, 1201)
    found = strokes.travel(twist, SimpleNamespace()).pose(clock)
    assert found == pytest.approx(poses(strokes), abs=1e-9)
    assert np.abs(found[:, 2]).max() > 0.8


@pytest.mark.parametrize(
    ("share", "count"),
    [(0.2, 1), (1.0, 1), (1.01, 2), (3.0, 3), (0.0, 1)],
)
def test_a_stroke_has_as_many_panels_as_its_longest_swing_needs(share, count):
    size = share * PANEL
    moves = Strokes(
        ("1", "2"), np.zeros((2, 2)), np.array([[size / 2, -size], [0.1, 0]])
    )
    panels = _Panels(moves)
    assert len(panels.stroke) == count + 2
    assert panels.edges == pytest.approx(
        np.append(np.arange(count) / count, [1.0, 1.5, 2.0])
    )
    assert panels.swing.shape == (count + 2, PANEL_NODES, 2)
    assert panels.strata.tolist() == ["1"] * count + ["2"] * 2
    way = panels.swing[:count, :, 1].ravel()
    assert way.min() >= -size
    assert (np.diff(way) <= 0).all()
    assert panels.rates[:count, :, 1] == pytest.approx(
        np.full((count, 4), -size / count)
    )


def test_feet_that_stand_slip_by_what_the_body_does_not_give_way():
    kinematics = Kinematics(load("hexapod"))
    robot = kinematics.robot
    strokes = Strokes(
        ("1", "12"), np.zeros((2, 2)), np.array([[0.1, 0.2], [0.04, 0.0]])
    )

    def still(stratum, swing, rates):
        return np.tile([0.01, 0.02, 0.3], (len(swing), 1)) * rates[:, :1]

    slip = strokes.travel(still, kinematics).slip
    clock = np.linspace(0, 1, 2001)
    swing = clock[:, None] * strokes.change[0]
    stance = kinematics.stance(swing)
    rates = np.tile(strokes.change[0], (len(clock), 1))
    moved = stance.rates * rates[:, robot.group_of_leg, None]
    twists = still("1", swing, rates)
    speed = np.linalg.norm(foot_velocities(stance.feet, moved, twists), axis=-1)
    total = np.trapezoid(speed, clock, axis=0) * robot.planted("1")
    assert slip(np.array([1.0]))[0] == pytest.approx(total, rel=1e-4, abs=1e-15)
    after = slip(np.array([2.0]))[0] - slip(np.array([1.0]))[0]
    assert (after > 0).all()


def test_fields_that_do_not_exist_are_refused(hexapod):
    with pytest.raises(ValueError, match="fields is 'Paper'; choose paper or lifted"):
        equations(hexapod, "Paper")
