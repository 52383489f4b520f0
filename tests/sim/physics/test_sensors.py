"""Sensors of feet that have unlike numbers of contacts, and legs that stand astride."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.library import load
from sim.physics import standing
from sim.physics.measure import NORMAL, Sensors
from sim.physics.standing import _Standing
from sim.world.servos import Channels


def test_contacts_that_a_foot_lacks_bear_nothing():
    """The slot of what is missing is another's, and does not count twice."""
    data = np.zeros((1, 60))
    first, second = np.array([0, 20]), np.array([40, 20])
    data[0, [0 + NORMAL, 20 + NORMAL, 40 + NORMAL]] = 3.0, 5.0, -1.0
    slots = [(first, np.array([1.0, 1.0])), (second, np.array([1.0, 0.0]))]
    sensors = SimpleNamespace(_slots=slots, _center_of_mass=57)
    assert Sensors.read(sensors, data).force.tolist() == [[3.0, 5.0]]


def test_groups_of_a_robot_that_stands_turned_are_at_zero():
    robot = load("hexapod-radial")
    rest = robot.start_qpos
    turned = dict(zip(robot.swing_joints, np.linspace(0.1, 0.6, 6), strict=True))
    for joint, angle in turned.items():
        rest[robot.model.joint(joint).qposadr[0]] = angle
    names = "swing_joints", "swing_gain", "group_of_leg", "groups"
    own = {name: getattr(robot, name) for name in names}
    standing = SimpleNamespace(standing_angle=turned.get, **own)
    channels = SimpleNamespace(robot=standing, model=robot.model)
    qpos = np.tile(rest, (2, 1))
    assert Channels.swing(channels, qpos) == pytest.approx(np.zeros((2, 2)), abs=1e-9)
    for joint, angle in robot.leg_angles(np.array([0.1, -0.2]), np.zeros(2)).items():
        qpos[1, robot.model.joint(joint).qposadr[0]] += angle
    assert Channels.swing(channels, qpos)[1] == pytest.approx([0.1, -0.2])


def test_of_several_legs_that_are_pushed_up_the_first_is_named(monkeypatch):
    """Legs 2 and 5 touch nothing, since two parts of the body push apart."""
    monkeypatch.setattr(standing, "say", lambda kind, **facts: (kind, facts))
    feet = {number: number for number in (1, 3, 4, 6)}
    own = SimpleNamespace(
        robot=SimpleNamespace(legs=(1, 2, 3, 4, 5, 6)), _feet=feet,
        _touched=lambda: [(number, 0) for number in feet],
        _contacts=lambda robots: [("hull", "tail")], _name=str,
    )  # fmt: skip
    pushing, aloft = _Standing.aloft(own)
    assert pushing == ("pushing", {"leg": 2, "one": "hull", "other": "tail"})
    assert aloft == ("aloft", {"leg": 2})


@pytest.mark.parametrize(
    ("pull", "weightless"),
    [(-9.81, False), (-1e-9, False), (0.0, True), (9.81, True)],
)
def test_a_robot_stands_where_gravity_pulls_it_down(pull, weightless):
    option = SimpleNamespace(gravity=[0.0, 0.0, pull])
    own = SimpleNamespace(model=SimpleNamespace(opt=option))
    assert bool([*_Standing.weightless(own)]) == weightless
