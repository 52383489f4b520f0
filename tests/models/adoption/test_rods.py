"""Meshes that are looked for in packages, rods in their place, and servos drafted."""

import re
from math import pi
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from models import Kinematics, load
from models.adoption.anatomy import servo_for
from models.adoption.source import _add, _in_package

MESH = re.compile(r"(\w+)/(.+)")


@pytest.mark.parametrize(("above", "found"), [(1, True), (4, True), (5, False)])
def test_packages_are_looked_for_in_four_folders_above_a_urdf(tmp_path, above, found):
    folder = tmp_path.joinpath(*"abcdef")
    folder.mkdir(parents=True)
    mesh = folder.parents[above - 1] / "leg" / "foot.stl"
    mesh.parent.mkdir()
    mesh.touch()
    name = _in_package(folder, MESH.fullmatch("leg/foot.stl"))
    assert (folder / name).is_file() == found


def test_parts_are_not_turned_unless_that_is_said():
    link = ET.Element("link")
    _add(link, "sphere", {"radius": "0.1"}, (1.0, 2.0, 3.0))
    _add(link, "sphere", {"radius": "0.1"}, (1.0, 2.0, 3.0), (0.0, 0.0, pi))
    turns = [origin.get("rpy") for origin in link.iter("origin")]
    assert turns == ["0 0 0", f"0 0 {pi:.9g}"]


def test_a_servo_that_suits_sags_by_four_tenths_of_a_milliradian():
    """Where half of the legs bear the weight on level legs."""
    robot = load("hexapod")
    servo, weight = servo_for(robot), 9.81 * float(robot.model.body_mass.sum())
    hips = np.array([Kinematics(robot).hinge(j)[1][:2] for j in robot.swing_joints])
    arm = np.linalg.norm(Kinematics(robot).standing.feet - hips, axis=1).max()
    assert weight * arm / 3 / servo.stiffness == pytest.approx(4e-4, rel=1e-3)
