"""The robot seen from above, against kinematics and the engine's own distances."""

import mujoco
import numpy as np
import pytest
import shapely

from models.contact.kinematics import Kinematics
from models.description.robot import Robot
from models.library import load
from sim.motion.poses import rotate
from sim.obstacles.clearance import Outline, hulls
from sim.preparation.setup import prepare

ROUNDING = 1e-12
ODDITIES = """
<mujoco>
  <asset><mesh name="wedge" vertex="0 0 0 .2 0 0 0 .1 0 0 0 .1 .05 .02 .03"/></asset>
  <worldbody>
    <body name="torso" pos="0 0 .3">
      <freejoint/>
      <geom name="wedge" type="mesh" mesh="wedge" pos=".1 0 0" euler="20 30 10"/>
      <geom name="drum" type="cylinder" size=".05 .02" pos="0 .2 0" euler="60 0 0"/>
      <geom name="egg" type="ellipsoid" size=".03 .05 .02" pos="0 -.2 0"/>
      <geom name="ghost" type="box" size="1 1 1" contype="0" conaffinity="0"/>
    </body>
    <geom name="floor" type="plane" size="1 1 1"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def outline(hexapod):
    return Outline(hexapod, hexapod.model)


def poses(rng, count):
    pose = rng.uniform((-1, -1, -4), (1, 1, 4), (count, 3))
    return pose, rng.uniform(-0.45, 0.45, (count, 2)), rng.uniform(0, 0.3, (count, 2))


def test_feet_are_where_the_kinematics_has_them(hexapod, outline):
    rng = np.random.default_rng(1)
    pose = rng.uniform((-1, -1, -4), (1, 1, 4), (20, 3))
    swing = rng.uniform(-0.45, 0.45, (20, 2))
    feet = Kinematics(hexapod).stance(swing).feet  # in the body frame
    expected = pose[:, None, :2] + rotate(feet, pose[:, 2:])
    cores = outline.solids.cores(outline.configurations(pose, swing, np.zeros((20, 2))))
    named = {p.name: core for p, core in zip(outline.solids.parts, cores, strict=True)}
    found = np.concatenate([named[f"foot_{leg}"] for leg in hexapod.legs], axis=1)
    assert found == pytest.approx(expected, abs=ROUNDING)


def test_a_lifted_leg_reaches_higher_and_so_less_or_more_far(outline):
    """The foot turns about the lift axis, from 52 mm below it, in its leg's plane."""
    zero, raised = np.zeros((1, 3)), np.full((1, 2), 0.3)
    cores = outline.solids.cores(outline.configurations(zero, zero[:, :2], raised))
    named = {p.name: core for p, core in zip(outline.solids.parts, cores, strict=True)}
    hip, foot = named["hip_3"][0, 0], named["foot_3"][0, 0]
    expected = 0.105 * np.cos(0.3) + 0.052 * np.sin(0.3)
    assert np.linalg.norm(foot - hip) == pytest.approx(expected, abs=1e-9)


def test_what_cannot_collide_has_no_outline(outline):
    names = {part.name for part in outline.solids.parts}
    assert "nose" not in names
    assert "floor" not in names
    assert len(names) == 1 + 4 * 6  # the plate; hip, femur, tibia and foot of each leg


def test_the_outline_at_rest_reaches_to_the_outer_feet(outline):
    rest = outline.configurations(*(np.zeros((1, n)) for n in (3, 2, 2)))[0]
    x, y, *_ = outline.solids.swept(rest[None]).bounds
    # feet at 0.15 and 0.18 m, 8 mm thick
    assert (x, y) == pytest.approx((-0.158, -0.188), abs=1e-6)
    assert outline.radius(rest) == pytest.approx(np.hypot(0.15, 0.18) + 0.008)


def odd_robot(monkeypatch):
    model = mujoco.MjModel.from_xml_string(ODDITIES)
    monkeypatch.setattr(Robot, "root", "torso")
    return Outline(load("hexapod"), model)


def test_every_solid_lies_within_its_part_s_core_and_radius(monkeypatch):
    """Points on the surface of any geom, projected, are covered by its part."""
    outline = odd_robot(monkeypatch)
    model = outline.model
    assert {part.name for part in outline.solids.parts} == {"wedge", "drum", "egg"}
    data = mujoco.MjData(model)
    data.qpos[3:7] = (0.9, 0.1, -0.3, 0.2)
    mujoco.mj_normalizeQuat(model, data.qpos)
    mujoco.mj_forward(model, data)
    cores = outline.solids.cores(np.array([data.qpos]))
    rng = np.random.default_rng(2)
    for core, part in zip(cores, outline.solids.parts, strict=True):
        covered = shapely.buffer(hulls(core)[0], part.radius + 1e-9, quad_segs=64)
        hit = _surface(model, data, part.geom, rng)
        assert len(hit) > 20
        assert shapely.covers(covered, shapely.points(hit)).all()


def _surface(model, data, geom, rng):
    """Where rays from all around hit one geom, seen from above."""
    middle, hits = data.geom_xpos[geom], []
    for direction in rng.normal(size=(400, 3)):
        direction /= np.linalg.norm(direction)
        start = middle - 2 * direction + rng.uniform(-0.1, 0.1, 3)
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            far = mujoco.mj_rayMesh(model, data, geom, start, direction)
        else:
            far = mujoco.mju_rayGeom(
                middle,
                data.geom_xmat[geom],
                model.geom_size[geom],
                start,
                direction,
                int(model.geom_type[geom]),
            )
        if far >= 0:
            hits.append((start + far * direction)[:2])
    return np.array(hits)


def test_joints_of_dead_bands_leave_the_outline_where_it_is(scenario):
    """Which lie between the others in the world."""
    setups = [prepare(scenario(backlash=band)) for band in (0.0, 0.01)]
    assert setups[0].model.nq < setups[1].model.nq
    given = poses(np.random.default_rng(2), 20)
    outlines = [Outline(setup.robot, setup.model) for setup in setups]
    cores = [one.solids.cores(one.configurations(*given)) for one in outlines]
    for there, same in zip(*cores, strict=True):
        np.testing.assert_allclose(there, same, atol=ROUNDING)


def test_a_robot_is_as_large_wherever_it_stands(hexapod, scenario):
    setup = prepare(scenario())
    outline = Outline(setup.robot, setup.model)
    here = outline.configurations(np.zeros((1, 3)), np.zeros((1, 2)), np.zeros((1, 2)))
    there = outline.configurations(
        np.array([[3.0, -7.0, 1.0]]), np.zeros((1, 2)), np.zeros((1, 2))
    )
    assert outline.radius(there[0]) == pytest.approx(outline.radius(here[0]))
