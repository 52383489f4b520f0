"""Soles are where the engine says that geoms come closest to the floor."""

import mujoco
import numpy as np
import pytest

from models.contact.kinematics import Kinematics, find_sole
from models.errors import ModelError
from models.library import load

CONE = " ".join(
    f"{0.03 * np.cos(a):.6f} {0.03 * np.sin(a):.6f} 0"
    for a in np.linspace(0, 2 * np.pi, 12, endpoint=False)
)
WORLD = """
<mujoco>
  <asset><mesh name="cone" vertex="{cone} 0.01 0 0.08"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body pos="0.1 0.2 0.5" quat="{quat}">
      <joint type="free"/>
      {geoms}
    </body>
  </worldbody>
</mujoco>
"""
SHAPES = {
    "sphere": 'type="sphere" size="0.02"',
    "capsule": 'type="capsule" size="0.01 0.05"',
    "box": 'type="box" size="0.02 0.03 0.01"',
    "cylinder": 'type="cylinder" size="0.02 0.03"',
    "ellipsoid": 'type="ellipsoid" size="0.02 0.03 0.01"',
    "mesh": 'type="mesh" mesh="cone"',
}


def placed(geoms, quat):
    text = WORLD.format(cone=CONE, geoms=geoms, quat=" ".join(map(str, quat)))
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_the_sole_is_the_point_nearest_to_the_floor(shape):
    rng = np.random.default_rng(3)
    for quat in rng.normal(size=(5, 4)):
        model, data = placed(f'<geom name="foot" pos="0.1 0 0" {shape}/>', quat)
        ends, (floor, foot) = np.empty(6), (model.geom(n).id for n in ("floor", "foot"))
        mujoco.mj_geomDistance(model, data, floor, foot, 10.0, ends)
        touch = find_sole(model, data, ["foot"]).touch(data)
        assert touch == pytest.approx(ends[3:], abs=1e-15)  # rounding


def test_a_flat_foot_stands_on_the_middle_of_its_face():
    model, data = placed(
        f'<geom name="foot" pos="0.1 0 0" {SHAPES["box"]}/>', (1, 0, 0, 0)
    )
    touch = find_sole(model, data, ["foot"]).touch(data)
    assert touch == pytest.approx([0.2, 0.2, 0.49])


def test_of_several_geoms_the_lowest_bear():
    balls = "".join(
        f'<geom name="ball_{x}" pos="0.0{x} 0 {z}" size="0.01"/>'
        for x, z in ((1, 0), (3, 0), (9, 0.05))
    )
    model, data = placed(balls, (1, 0, 0, 0))
    touch = find_sole(model, data, ["ball_1", "ball_3", "ball_9"]).touch(data)
    assert touch == pytest.approx([0.12, 0.2, 0.49])


def test_a_plane_is_no_foot():
    model, data = placed('<geom size="0.1"/>', (1, 0, 0, 0))
    with pytest.raises(ModelError, match="foot 'floor' is a plane: give it a sphere"):
        find_sole(model, data, ["floor"])


@pytest.mark.parametrize("name", ["hexapod", "quadruped", "octopod"])
def test_feet_and_weight_are_where_the_engine_has_them_to_rounding(name):
    """Samples a third of a turn apart amplify no rounding of the sines fitted."""
    robot = load(name)
    kinematics, data = Kinematics(robot), mujoco.MjData(robot.model)
    angles = np.random.default_rng(0).uniform(-0.5, 0.5, (2, 5, len(robot.groups)))
    stance, joints = kinematics.stance(*angles), robot.joint_angles(*angles)
    feet = [robot.model.geom(leg.foot[0]).id for leg in robot.leg_cards]
    root = robot.model.body(robot.root).id
    for row, (swing, lift) in enumerate(zip(*joints, strict=True)):
        data.qpos[:] = kinematics.level_qpos
        for k, leg in enumerate(robot.leg_cards):
            data.joint(leg.swing).qpos[0] += swing[k]
            data.joint(leg.lift).qpos[0] += lift[k]
        mujoco.mj_kinematics(robot.model, data)
        mujoco.mj_comPos(robot.model, data)
        middle = data.xpos[root, :2]
        places = data.geom_xpos[feet, :2] - middle
        assert stance.feet[row] == pytest.approx(places, abs=1e-15)  # 1e-16 measured
        weight = data.subtree_com[root, :2] - middle
        assert stance.center_of_mass[row] == pytest.approx(weight, abs=1e-15)
