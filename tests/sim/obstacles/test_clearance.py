"""Clearance against the engine's own distances, and its bound between samples."""

import mujoco
import numpy as np
import pytest

from models.library import load as load_robot
from sim.obstacles.clearance import Outline, Surroundings
from sim.scenarios import obstacles as shapes
from sim.world.model import build, load

WALLS = shapes.decode(
    [
        {"kind": "wall", "points": [[-0.5, 0.4], [0.6, 0.4], [0.6, -0.5]]},
        {"kind": "box", "center": [-0.45, -0.1], "size": [0.1, 0.2], "yaw": 0.4},
        {"kind": "polygon", "points": [[0.1, -0.4], [0.4, -0.5], [0.0, -0.6]]},
    ]
)


@pytest.fixture(scope="module")
def around():
    from sim.scenarios.body_path import line
    from sim.scenarios.scenario import Scenario

    robot = load_robot("hexapod")
    path = line((0.01, 0.0, 0.0))
    made = Scenario(name="walled", segments=1, path=path, obstacles=WALLS)
    return Surroundings(Outline(robot, load(build(robot, made))), WALLS)


def configurations(around, count, spread=0.1):
    rng = np.random.default_rng(7)
    pose = rng.uniform((-spread, -spread, -3), (spread, spread, 3), (count, 3))
    swing, lift = (rng.uniform(low, 0.4, (count, 2)) for low in (-0.4, 0.0))
    return around.outline.configurations(pose, swing, lift)


def engine_distance(around, qpos):
    """Least distance between any solid of the robot and any obstacle, in space."""
    model = around.outline.model
    data = mujoco.MjData(model)
    data.qpos = qpos
    mujoco.mj_kinematics(model, data)
    solids = [
        i for i in range(model.ngeom) if model.geom(i).name.startswith("obstacle_")
    ]
    return min(
        mujoco.mj_geomDistance(model, data, part.geom, solid, 1.0, None)
        for part in around.outline.solids.parts
        for solid in solids
    )


def test_clearance_is_the_engine_s_distance_from_upright_walls(around):
    """Walls are higher than the robot, so distances in space and plane are the same."""
    qpos = configurations(around, 60)
    found = around.clearances(qpos).least
    expected = np.array([engine_distance(around, row) for row in qpos])
    apart = expected > 0
    assert apart.sum() > 30
    assert found[apart] == pytest.approx(expected[apart], abs=1e-6)  # the engine's own
    assert (found[~apart] <= 0).all()


def test_overlap_is_as_deep_as_the_foot_has_gone_in(around):
    """The foot's centre 20 mm behind a wall's face, the wall being thick."""
    thick = shapes.decode([{"kind": "box", "center": [0.6, 0], "size": [0.88, 2]}])
    inside = Surroundings(around.outline, thick)  # its face is at x = 0.16
    zero = np.zeros((1, 2))
    qpos = around.outline.configurations(np.array([[0.03, 0, 0]]), zero, zero)
    assert inside.clearances(qpos).least == pytest.approx(
        [-0.028], abs=1e-6
    )  # digits of the robot's file


def test_nothing_comes_closer_between_samples_than_the_bound(around):
    """Checked where the dense motion between two far samples is known."""
    ends = configurations(around, 40, spread=0.05)
    for a, b in zip(ends[:-1], ends[1:], strict=True):
        pose_a, pose_b = _pose(a), _pose(b)
        s = np.linspace(0, 1, 101)[:, None]
        pose = pose_a + 0.2 * s * (pose_b - pose_a)
        zero = np.zeros((101, 2))
        dense = around.outline.configurations(pose, zero, zero)
        coarse = around.clearances(dense[::20])
        fine = around.clearances(dense).least
        between = np.array([fine[k : k + 21].min() for k in range(0, 100, 20)])
        assert (between >= coarse.bound - 1e-12).all()
        way = [np.linalg.norm(np.diff(core, axis=0), axis=-1) for core in coarse.cores]
        farthest = np.max([moved.max(axis=-1) for moved in way], axis=0)
        assert (coarse.bound > between - farthest).all()  # and it is no lazy bound


def _pose(qpos):
    return np.array([qpos[0], qpos[1], 2 * np.arctan2(qpos[6], qpos[3])])


def test_the_nearest_part_and_obstacle_are_named(around):
    zero = np.zeros((1, 2))
    pose = np.array([[0.0, 0.15, 0.0]])
    assert around.nearest(around.outline.configurations(pose, zero, zero)[0]) == (
        "foot_1",
        1,
    )
