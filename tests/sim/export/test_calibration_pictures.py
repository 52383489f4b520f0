"""Pictures and the printed sheet by which servos are found."""

import re
from contextlib import nullcontext

import numpy as np
import pytest
from PIL import Image

from models import Kinematics, load
from sim.export import calibration
from tests.hostile import named_otherwise

ROBOT = "hexapod-classroom"


def test_a_joint_is_drawn_from_its_own_side_of_the_robot(tmp_path, monkeypatch):
    """The camera alone, without a driver: its azimuth is the way that it looks."""
    robot, seen = load(ROBOT), []

    class Camera:
        def update_scene(self, data, view):
            way = np.radians(view.azimuth)
            stands = -np.array([np.cos(way), np.sin(way)])
            seen.append((stands, view.lookat.copy(), data.qpos[:3].copy()))

        def render(self):
            return np.zeros((2, 2, 3), dtype=np.uint8)

    monkeypatch.setattr("mujoco.Renderer", lambda *_, **__: nullcontext(Camera()))
    calibration._draw(robot, tmp_path)
    kinematics = Kinematics(robot)
    hips = [kinematics.hinge(joint)[1][:2] for joint in robot.card.joints]
    assert len(seen) == 2 * len(hips)
    for (stands, middle, torso), hip in zip(
        seen, np.repeat(hips, 2, axis=0), strict=True
    ):
        assert (middle == torso).all()
        assert stands @ hip > 0.7 * np.linalg.norm(hip)  # within 45 degrees


@pytest.mark.full
@pytest.mark.render
@pytest.mark.usefixtures("driver")
def test_each_joint_is_drawn_at_both_marks_in_colour(tmp_path):
    named = named_otherwise(tmp_path, "../../evil")  # no picture beside the folder
    robot, folder = load(str(named)), tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    before = set(tmp_path.rglob("*"))
    calibration.draw(robot, folder, allow_external=False)
    made = {folder / f"joint-{n}.png" for n in range(1, 1 + len(robot.card.joints))}
    assert set(tmp_path.rglob("*")) - before == made
    for file in made:
        picture = np.asarray(Image.open(file)).astype(int)
        red = picture[..., 0] > picture[..., 1:].max(axis=-1) + 60
        left, right = np.split(red, 2, axis=1)
        assert left.any()
        assert right.any()
        assert (left != right).any()  # the joint has moved
        assert red.mean() < 0.05  # and nothing else is red


def test_the_sheet_has_its_size_and_a_ring_of_a_degree_for_each_foot(tmp_path):
    robot = load(ROBOT)
    calibration.sheet(robot, tmp_path / "feet.svg")
    text = (tmp_path / "feet.svg").read_text()
    millimetres = re.findall(r'(?:width|height)="([\d.]+)mm"', text)
    feet = Kinematics(robot).standing.feet
    edge = 4 * calibration.SHEET_EDGE  # two on every side
    size = np.array(millimetres, dtype=float) / 1e3
    assert size == pytest.approx(np.ptp(feet, axis=0) + edge, abs=1e-6)  # as written
    number = r"(-?[\d.]+)"
    line = f'class="leg" d="M {number} {number} L {number} {number}"'
    legs = np.array(re.findall(line, text), dtype=float)  # from hip to foot [mm]
    lengths = np.hypot(*(legs[:, 2:] - legs[:, :2]).T)
    hips = [Kinematics(robot).hinge(leg.swing)[1][:2] for leg in robot.leg_cards]
    assert lengths == pytest.approx(1e3 * np.hypot(*(feet - hips).T), abs=2e-3)
    arcs = re.findall(f"a {number} {number} 0 1 0 {number} 0 a", text)
    radii = np.radians(1) * lengths
    assert np.array(arcs, dtype=float) == pytest.approx(
        np.stack([radii, radii, 2 * radii], axis=1), abs=2e-3
    )
    assert (np.sort(size) < [0.297, 0.420]).all()  # A3, as docs/first-robot.md says
