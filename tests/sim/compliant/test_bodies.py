"""Bodies of the compliant prediction: soles, inertia, servos, grips and rotations."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim.compliant.anatomy import _outermost, robots_of
from sim.compliant.increment import _grip, _side
from sim.compliant.march import Track
from sim.compliant.phases import (
    LOADED,
    Phases,
)
from sim.compliant.places import cross, rotation, skew
from sim.compliant.prediction import phases_of
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

CORNERS = 4  # of a sole, at most
ON_EDGE = 1e-10  # [rad]; joints as close to an end of backlash are on either side
SMALL = 1e-4  # [rad], below which a rotation is a polynomial


@pytest.fixture(scope="module")
def phases():
    return phases_of(prepare(load_scenario("line")))


@pytest.mark.parametrize("lean", [(0.0, 0.0), (0.1, 0.0), (0.0, -0.05)])
def test_motion_in_the_world_has_angles_margin_and_loads_of_a_track(phases, lean):
    """A body that has turned, over four of six feet; the weight falls along gravity."""
    g = 9.81
    down = np.array([g * np.sin(lean[0]), g * np.sin(lean[1]), -g])
    robots = SimpleNamespace(gravity=down[None], weight=np.array([100.0]))
    own = Phases(SimpleNamespace(height=0.02), robots)
    yaw, roll, pitch = 0.4, 0.03, -0.05
    turned = rotation(np.array([0, 0, yaw]))
    turned = (
        turned @ rotation(np.array([0, pitch, 0])) @ rotation(np.array([roll, 0, 0]))
    )
    points = np.array([[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1], [0.3, 0.3]])
    load = 100.0 * np.array([0.3, 0.3, 0.2, 0.2, 0.9 * LOADED])
    track = Track(
        np.zeros(1, int), np.zeros(1), np.array([[1.0, 2.0, 0.12]]), turned[None],
        np.ones((1, 5)), load[None], np.zeros((1, 5, 3)),
        np.array([[0.01, 0.02, 0.03]]), points[None],
    )  # fmt: skip
    found = own._motion(track, np.zeros(1, int))
    assert found.pose[0] == pytest.approx([1.0, 2.0, yaw])
    assert found.lean[0] == pytest.approx([0.1, roll, pitch])
    fall = 0.1 + 0.03  # from the centre of mass to the floor
    place = [0.01 + fall * down[0] / g, 0.02 + fall * down[1] / g]
    assert found.margin[0] == pytest.approx(0.1 - np.abs(place).max())
    assert own.leans == any(lean)


def test_a_grip_is_more_across_legs_than_along_them():
    arm = np.zeros((1, 2, 1, 3))
    arm[0, 0, 0], arm[0, 1, 0] = (3.0, 4.0, -1.0), (0.0, -2.0, -1.0)
    places = SimpleNamespace(arm=arm, anchor=np.zeros((1, 2, 2, 3)))
    across = np.array([[1.5, 0.5]])
    found = _grip(SimpleNamespace(across=across), places)
    along, side, up = np.array([0.6, 0.8, 0]), np.array([-0.8, 0.6, 0]), [0.0, 0, 1]
    assert found[0, 0] @ along == pytest.approx(along)
    assert found[0, 0] @ side == pytest.approx(1.5 * side)
    assert found[0, 0] @ up == pytest.approx(np.array(up))
    assert found[0, 1] @ [1.0, 0, 0] == pytest.approx([0.5, 0, 0])
    assert _grip(SimpleNamespace(across=np.ones((1, 2))), places) is None


@pytest.mark.parametrize(
    ("loose", "side"), [(0.02, 1), (0.0099, 0), (-0.02, -1), (-0.0099, 0), (0.0, 0)]
)
def test_joints_are_at_the_stop_beyond_which_they_lie(loose, side):
    robots = SimpleNamespace(slack=np.full((1, 1, 1), 0.02))
    given = np.full((1, 1, 1), loose)
    assert _side(robots, given) == side
    before = np.full((1, 1, 1), 1 - abs(side))
    assert _side(robots, given, before) == side
    edge = np.full((1, 1, 1), 0.01 + 0.5 * ON_EDGE)
    assert _side(robots, edge, before) == before


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.99 * SMALL, 1.01 * SMALL, 0.1, 3.0])
def test_rotations_turn_about_their_axis_by_their_length(size):
    axis = np.array([2.0, -1.0, 2.0]) / 3
    R = rotation(size * axis)
    assert pytest.approx(np.eye(3), abs=1e-14) == R @ R.T
    assert R @ axis == pytest.approx(axis)
    side = np.cross(axis, [1.0, 0, 0])
    turned = np.cos(size) * side + np.sin(size) * np.cross(axis, side)
    assert R @ side == pytest.approx(turned, abs=1e-14)


def test_cross_products_are_numpys_and_those_of_their_matrices():
    a, b = np.random.default_rng(0).normal(size=(2, 5, 3))
    assert cross(a, b) == pytest.approx(np.cross(a, b))
    assert (skew(a) @ b[..., None])[..., 0] == pytest.approx(np.cross(a, b))


def test_points_of_a_sole_are_its_corners_and_no_more_than_four():
    corners = [[0.0, 0.0, 0.0], [0.0, 3.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0]]
    within = [[2.0, 1.5, 0.0], [0.0, 1.5, 0.0]]
    assert sorted(_outermost(np.array([*within, *corners])).tolist()) == [2, 3, 4, 5]
    assert len(corners) == CORNERS
    few = np.array([[0.0, 0, 0], [1.0, 0, 0], [1.0 + 0.9e-4, 0, 0]])
    assert sorted(_outermost(few).tolist()) == [0, 2]
    apart = np.array([[0.0, 0, 0], [1.0, 0, 0], [1.0 + 1.1e-4, 0, 0]])
    assert sorted(_outermost(apart).tolist()) == [0, 1, 2]


@pytest.mark.parametrize("robot", ["hexapod", "quadruped"])
def test_inertia_and_mass_are_those_of_all_bodies(robot):
    """By the engine's own matrix, for turns of the root about the centre of mass."""
    import mujoco

    setup = prepare(load_scenario("line", {"robot": robot}))
    model, found = setup.model, phases_of(setup)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_fwdPosition(model, data)
    root = model.body(setup.robot.root)
    address = int(root.dofadr[0])
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    own = whole[address : address + 6, address : address + 6]
    mass = own[0, 0]
    assert found.robots.mass[0] == pytest.approx(mass)
    turned = data.xmat[root.id].reshape(3, 3)
    away = (data.subtree_com[root.id] - data.xpos[root.id]) @ turned
    about = own[3:, 3:] - mass * (away @ away * np.eye(3) - np.outer(away, away))
    anatomy = found.mechanics.anatomy
    assert anatomy.inertia == pytest.approx(about, rel=1e-6, abs=1e-9)
    links = (anatomy.link_mass[..., None] * anatomy.link_center).sum(axis=(0, 1))
    centre = (links + anatomy.body_mass * anatomy.body_center) / mass
    assert centre == pytest.approx(away, abs=1e-9)


def test_servos_and_floor_are_read_from_the_world():
    changes_ = {"servo_stiffness": 44.0, "servo_damping": 1.3}
    setup = prepare(
        load_scenario("line", changes_ | {"backlash": 0.02, "friction": 0.65})
    )
    found = phases_of(setup)
    robots, model = found.robots, setup.model
    real = found.mechanics.anatomy.axis.any(axis=-1)
    assert robots.stiffness[0][real] == pytest.approx(44.0)
    assert robots.slack[0][real] == pytest.approx(0.02)
    assert robots.friction == pytest.approx(np.full_like(robots.friction, 0.65))
    damping = robots.damping[0][real]
    assert damping == pytest.approx(np.full_like(damping, 1.3), abs=0.2)
    assert (robots.offset == 0).all()
    assert robots_of(setup.robot, model, found.mechanics.anatomy).gravity[
        0
    ] == pytest.approx(model.opt.gravity)
