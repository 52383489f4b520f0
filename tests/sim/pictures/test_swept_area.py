"""The floor under a robot on films: its outline in each frame, and what it swept."""

from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from models.library import load
from sim.obstacles.clearance import Outline
from sim.pictures.marks import FINENESS, swept

REACH = 0.234  # [m], of the hexapod's outer feet


@pytest.fixture(scope="module")
def outline():
    robot = load("hexapod")
    return Outline(robot, robot.model)


@pytest.fixture(scope="module")
def walk(outline):
    """Half a metre straight on, three turns of a quarter on the way, legs at rest."""
    s = np.linspace(0, 1, 61)
    pose = np.stack([0.5 * s, 0 * s, 1.5 * np.pi * s], axis=-1)
    zero = np.zeros((len(s), 2))
    return SimpleNamespace(qpos=outline.configurations(pose, zero, zero), reach=REACH)


def shown(drawing, frame):
    """The floor that a drawing covers in a frame, and the sum of all areas."""
    first, count = drawing.visible(frame)
    triangles = shapely.polygons(drawing.points[first : first + count])
    return shapely.union_all(triangles), float(shapely.area(triangles).sum())


def test_what_is_swept_grows_to_all_outlines_and_never_overlaps(outline, walk):
    clock = SimpleNamespace(rows=np.arange(61))
    drawing = swept(outline.solids, walk, clock)
    tolerance = FINENESS * REACH
    for frame in (0, 20, 60):
        covered, painted = shown(drawing, frame)
        rows = np.arange(frame + 1)
        expected = outline.solids.swept(walk.qpos[rows])
        assert expected.buffer(tolerance).covers(covered)
        assert covered.buffer(tolerance).covers(expected)
        assert painted == pytest.approx(covered.area, rel=1e-9)
