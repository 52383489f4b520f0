"""Robots with parts whose names the world of a walk gives are refused."""

import numpy as np
import pytest

from models import load
from models.errors import ModelError
from sim.preparation.setup import prepare
from sim.scenarios.obstacles import decode
from sim.world.sensors import Touches

GEOM = '<geom name="{}" size="0.01"/>'
LOADED = {"payload": (0.5, 0.0, 0.0, 0.0)}
WALL = {"kind": "box", "center": [2.0, 2.0], "size": [0.5, 0.5]}


@pytest.mark.parametrize(
    ("part", "given"),
    [
        (f'<body name="payload">{GEOM.format("")}</body>', LOADED),
        (GEOM.format("payload"), LOADED),
        (GEOM.format("obstacle_1_1"), {"obstacles": decode([WALL])}),
        (
            f'<body><joint name="backlash_lift_2"/>{GEOM.format("")}</body>',
            {"backlash": 0.01},
        ),
    ],
)
def test_the_part_is_named_with_the_way_out(part, given, edited, scenario):
    """A run's own model.xml has such parts, and its robot may be walked again."""
    robot = edited('<body name="leg_1"', f'{part}<body name="leg_1"')
    with pytest.raises(ModelError, match="repeated name '[a-z0-9_]+' in .*: rename it"):
        prepare(scenario(**given), robot)


def test_a_part_that_is_called_as_the_floor_that_joins_it_is_refused(edited, scenario):
    part, first = GEOM.format("scene_floor"), '<body name="leg_1"'
    radians = '<include file="scene.xml"/>', '<compiler angle="radian"/>'
    floorless = *radians, 'geom1="floor"', 'body1="world"'
    robot = edited(*floorless, first, f"{part}{first}")
    with pytest.raises(ModelError, match="repeated name 'scene_floor' in .*: rename"):
        prepare(scenario(), robot)


STANDING = """
<geom name="obstacle_wall" type="box" size="0.1 0.1 0.1" pos="2 4 0"/>
<geom name="obstacle_3_1" type="box" size="0.1 0.1 0.1" pos="3 3 0"/>
<geom name="obstacle_0_1" type="box" size="0.1 0.1 0.1" pos="3 4 0"/>
<body name="torso"
"""
SENSED = """
<asset><mesh name="obstacle_head" vertex="0 0 0  .01 0 0  0 .01 0  0 0 .01"/></asset>
<sensor><rangefinder name="obstacle_front" site="ahead"/></sensor></mujoco>
"""
HEAD = """
<site name="ahead"/><geom type="mesh" mesh="obstacle_head" mass="0.001" contype="0"/>
<body name="leg_1"
"""


def test_parts_that_are_called_as_obstacles_stay(edited, scenario, tmp_path):
    """Only those of a walk, which have contact sensors of their names, are replaced.

    All four are watched.
    """
    before = '<body name="torso"', STANDING, '<body name="leg_1"', HEAD
    robot = edited(*before, "</keyframe>\n</mujoco>", f"</keyframe>{SENSED}")
    setup = prepare(scenario(obstacles=decode([WALL])), robot)
    names = {setup.model.geom(i).name for i in range(setup.model.ngeom)}
    assert names >= {"obstacle_wall", "obstacle_3_1", "obstacle_1_1"}
    assert setup.model.mesh("obstacle_head").id >= 0
    touches = Touches(setup.model)
    touches.read(np.ones((1, setup.model.nsensordata)))
    assert touches.count == 4
    walked = tmp_path / "walked"
    walked.mkdir()
    (walked / "model.xml").write_text(setup.world.text)
    (walked / "model.toml").write_text(robot.card_text)
    again = prepare(scenario(), load(str(walked / "model.xml"))).model
    left = {again.geom(i).name for i in range(again.ngeom)}
    assert names - left == {"obstacle_1_1"}


def test_a_joint_that_is_called_as_if_it_were_loose_is_like_any_other(edited, scenario):
    pan = f'<body><joint name="backlash_pan" range="-1 1"/>{GEOM.format("")}</body>'
    robot = edited('<body name="leg_1"', f'{pan}<body name="leg_1"')
    model = prepare(scenario(backlash=0.01), robot).model
    key = model.key("start").qpos
    assert model.nq == robot.model.nq + len(robot.card.joints) == len(key)
    for joint in robot.card.joints:
        assert key[model.joint(f"backlash_{joint}").qposadr[0]] == 0.0
        standing = robot.standing_angle(joint)
        assert key[model.joint(joint).qposadr[0]] == pytest.approx(standing)
