"""Meshes that are looked for in packages, rods in their place, and servos drafted."""

from math import pi
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from models import Kinematics, load
from models.adoption.anatomy import servo_for
from models.adoption.urdf import _add, with_packages


@pytest.mark.parametrize(("above", "found"), [(1, True), (4, True), (5, False)])
def test_packages_are_looked_for_in_four_folders_above_a_urdf(tmp_path, above, found):
    folder = tmp_path.joinpath(*"abcdef")
    folder.mkdir(parents=True)
    mesh = folder.parents[above - 1] / "leg" / "foot.stl"
    mesh.parent.mkdir()
    mesh.touch()
    given = "package://leg/foot.stl"
    named = with_packages(f"'{given}'", folder)
    assert (folder / named.strip("'")).is_file() == found
    assert (named == f"'{given}'") != found


@pytest.mark.parametrize("called", ["other", "own", None])
def test_a_file_is_that_of_the_package_which_is_named(tmp_path, called):
    """That of a package in a folder of another name only if it says nothing else."""
    folder = tmp_path / "robot" / "urdf"
    folder.mkdir(parents=True)
    for place in ("robot", "other"):
        (tmp_path / place / "foot.stl").parent.mkdir(exist_ok=True)
        (tmp_path / place / "foot.stl").touch()
    if called:
        text = f"<package>\n  <name> {called}\n</name></package>"
        (tmp_path / "robot" / "package.xml").write_text(text)
    other = with_packages("package://other/foot.stl", folder)
    assert other == (
        "../foot.stl" if called in ("other", None) else "../../other/foot.stl"
    )
    mine = with_packages("package://own/foot.stl", folder)
    assert (mine == "../foot.stl") == (called != "other")


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


def test_the_package_that_a_urdf_is_in_comes_before_another_copy_of_it(tmp_path):
    folder = tmp_path / "mine" / "robot-master" / "urdf"
    folder.mkdir(parents=True)
    (tmp_path / "robot").mkdir()
    for place in (tmp_path / "robot", folder.parent):
        (place / "foot.stl").touch()
    package = folder.parent / "package.xml"
    for text in ("", "<package><!-- <name>x</name> --><name>robot</name></package>"):
        package.write_text(text)
        assert with_packages("package://robot/foot.stl", folder) == "../foot.stl"
    package.unlink()
    assert with_packages("package://robot/foot.stl", folder) == "../foot.stl"
