"""How far a measured field reaches: as far as an opposite stroke agrees with it."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from models import MeasurementError
from models.motion.twists import MeasuredField
from planner import Flow
from sim.experiments import identification
from sim.experiments.identification import confirmed, whole_range

WAY_PARTS = 200  # parts of the way in which predictions are summed

FIELD = MeasuredField("1", (1.0, -0.5), 0.1, (Polynomial([0.1]),) * 3, 0.0)
ROBOT = SimpleNamespace(groups="12", swing_range={"1": (-0.3, 0.5), "2": (-0.6, 0.2)})
SETUP = SimpleNamespace(robot=ROBOT)
WAYS = np.linspace(0.0, 0.3, WAY_PARTS)


@pytest.mark.parametrize(
    ("direction", "reach"),
    [((1.0, 0.0), 0.3), ((0.0, 1.0), 0.2), ((1.0, -0.5), 0.3), ((0.5, 1.0), 0.2)],
)
def test_a_swing_goes_as_far_as_the_nearest_end_of_a_range(direction, reach):
    assert whole_range(SETUP, direction) == pytest.approx(reach)


def test_a_stroke_that_turns_on_beyond_half_a_turn_is_told_without_a_jump(monkeypatch):
    way = np.linspace(0.3, -0.3, 61)
    yaw = np.pi + way
    pose = np.stack([0 * way, way, np.arctan2(np.sin(yaw), np.cos(yaw))], axis=1)
    assert np.ptp(pose[:, 2]) > 6
    monkeypatch.setattr(identification, "swing", lambda *given: (way, pose, 0.0))
    ways, poses = identification._stroke_back(SETUP, "a", (0.3,))
    assert ways.tolist() == sorted(way)
    assert np.diff(poses[:, 2]) == pytest.approx(np.diff(ways), abs=1e-12)
    assert poses[:, 1].tolist() == ways.tolist()


def test_a_stroke_back_goes_back_and_shorter_where_the_long_one_fails(monkeypatch):
    tried = []

    def swing(setup, name, span):
        tried.append(span)
        if abs(span) > 0.2:
            raise MeasurementError("the robot tips over")
        return np.array([0.0, span]), np.zeros((2, 3)), 0.0

    monkeypatch.setattr(identification, "swing", swing)
    ways, _ = identification._stroke_back(SETUP, "a", (0.3, 0.1))
    assert (tried, ways.tolist()) == ([-0.3, -0.1], [-0.1, 0.0])
    with pytest.raises(
        MeasurementError, match="opposite direction: the robot tips over"
    ):
        identification._stroke_back(SETUP, "a", (0.4, 0.3))


def test_a_stroke_back_that_hardly_moves_confirms_nothing(monkeypatch):
    """As of servos that are damped so much that they do not come to their commands."""
    way = np.array([-0.04, 0.0])
    monkeypatch.setattr(identification, "_stroke_back", lambda *given: (way, np.eye(3)))
    with pytest.raises(MeasurementError, match="direction came to 0.04 of 0.1 rad"):
        confirmed(SETUP, "a", FIELD)


@pytest.mark.parametrize(
    ("agrees", "reach"),
    [
        (0.2, WAYS[WAYS <= 0.2].max()),  # the last place that agrees
        (0.1, 0.1),  # no less than the span, wherever places are
        (0.3, 0.3),
    ],
)
def test_a_field_reaches_to_the_last_place_that_agrees(monkeypatch, agrees, reach):
    way = np.array([-0.3, 0.3])
    monkeypatch.setattr(identification, "_stroke_back", lambda *given: (way, None))
    monkeypatch.setattr(
        identification, "_shares", lambda setup, field, ways, *rest: ways > agrees
    )
    assert confirmed(SETUP, "a", FIELD).reach == pytest.approx(reach, abs=1e-12)


def test_a_stroke_that_goes_a_tenth_farther_misses_by_a_tenth():
    """By less where the stroke is short: of little motion any miss is a large share."""
    forward, nothing = Polynomial([0.1]), Polynomial([0.0])
    field = MeasuredField("1", (1.0,), 0.1, (forward, nothing, nothing), 0.0)
    setup = SimpleNamespace(kinematics=SimpleNamespace(reach=0.1))
    ways, way = np.linspace(0.0, 0.3, 61), np.array([-0.3, 0.3])
    pose = np.stack([0.11 * way, 0 * way, 0 * way], axis=1)
    shares = identification._shares(setup, field, ways, way, pose)
    long = ways > 0.0499  # half of the span
    assert shares[long] == pytest.approx(0.1)
    assert (shares[~long] < 0.0999).all()


def test_legs_are_brought_to_the_end_of_a_swing_each_by_its_group_s_share():
    """Through fields that move no body: the second group goes half as far, back."""
    equations = SimpleNamespace(
        system=SimpleNamespace(stratum_of={"both": "12", "one": "2", "two": "1"}),
        swings={"both": (1.0, -0.5), "one": (1.0, 0.0), "two": (0.0, 1.0)},
        twists={"both": (0.1, 0, 0), "one": (0, 0, 0), "two": (0, 0, 0)},
    )
    setup = SimpleNamespace(equations=equations)
    found = identification._approach(setup, (1.0, -0.5), 0.4)
    assert found == [Flow("2", "one", 0.4), Flow("1", "two", -0.2)]
    assert identification._approach(setup, (0.0, 1.0), 0.4) == [Flow("1", "two", 0.4)]
