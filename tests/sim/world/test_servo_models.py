"""Servos, motors and floors of worlds: numbers of their compiled models."""

from dataclasses import replace
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models import load
from models.description import actuators_of
from sim.errors import UsageError
from sim.preparation.setup import prepare
from sim.scenarios.body_path import line
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import Scenario
from sim.world.floor import ensure_floor, scene
from sim.world.imperfections import turned
from sim.world.motors import common_servo, inertia_share, undamped_joints
from sim.world.sensors import EVERYTHING, Touches
from sim.world.servos import ServoSettings, _gear_down, servo_settings

CELL = 0.01  # [m] between heights, or more where the floor is large
FLOOR_MARGIN = 0.5  # [m] of floor around the path
LEVEL = 1e-3  # [rad]; a plane tilted less is horizontal, as single precision writes it
SUNK = 0.01  # [m] below the floor, so that no gap is visible


def setup(**changes):
    return prepare(load_scenario("line", changes))


def plain(**changes):
    given = {"name": "x", "stiffness": None, "damping": None, "rate": 0.0,
             "resolution": 0.0, "feed_forward": None} | changes  # fmt: skip
    return ServoSettings(**given)


@pytest.mark.parametrize(
    ("asked", "stiffness", "feeds"),
    [(None, 299.9, True), (None, 300.0, False), (True, 9e9, True), (False, 1.0, False),
     ("predicted", 9e9, True)],
)  # fmt: skip
def test_soft_servos_are_fed_forward_unless_that_is_asked_otherwise(
    asked, stiffness, feeds
):
    assert plain(feed_forward=asked).feeds_forward(stiffness) == feeds


def test_what_servos_came_to_stands_in_their_table():
    table = plain(damping_ratio=1.0, armature=0.1).table((5.0, 0.2))
    assert (table["stiffness"], table["damping"]) == (5.0, 0.2)
    assert not {"damping_ratio", "armature", "kind"} & table.keys()
    assert plain(stiffness=3.0).table(None)["stiffness"] == 3.0


def test_settings_of_a_scenario_win_over_those_of_a_make():
    robot = load("hexapod-classroom")
    made = servo_settings(load_scenario("line", {"servo": "mg996r"}), robot.card)
    kind = made.kind
    assert (made.stiffness, made.torque) == (kind.stiffness, kind.stall_torque)
    assert (made.speed, made.resolution) == (kind.no_load_speed, kind.resolution)
    assert (made.damping, made.damping_ratio) == (None, 1.0)
    own = {"servo": "mg996r", "servo_stiffness": 7.0, "servo_damping": 0.3,
           "command_rate": 40.0, "resolution": 0.01}  # fmt: skip
    asked = servo_settings(load_scenario("line", own), robot.card)
    assert (asked.stiffness, asked.damping, asked.damping_ratio) == (7.0, 0.3, None)
    assert (asked.rate, asked.resolution) == (40.0, 0.01)
    ideal = servo_settings(load_scenario("line", {"servo": "ideal"}), robot.card)
    assert (ideal.rate, ideal.resolution, ideal.torque) == (0.0, 0.0, None)
    zero = {"servo": "mg996r", "resolution": 0.0}
    assert servo_settings(load_scenario("line", zero), robot.card).resolution == 0.0


def test_a_servo_behind_a_gear_is_as_stiff_on_its_joint():
    """A gear of 3 multiplies torques by 3 and divides angles by 3."""

    def servo(damping):
        return SimpleNamespace(
            gear=np.array([3.0, 0, 0, 0, 0, 0]), gainprm=np.array([2.0, 0]),
            biasprm=np.array([0.0, -2.0, damping]), armature=0.1,
            ctrlrange=np.array([-3.0, 6.0]), forcerange=np.array([-1.0, 2.0]),
        )  # fmt: skip

    one = servo(-0.5)
    _gear_down(one)
    assert one.gear[0] == 1
    assert one.gainprm[0] == 18.0
    assert one.biasprm[1:].tolist() == [-18.0, -4.5]
    assert one.armature == pytest.approx(0.9)
    assert one.ctrlrange == [-1.0, 2.0]
    assert one.forcerange == [-3.0, 6.0]
    ratio = servo(0.7)
    _gear_down(ratio)
    assert ratio.biasprm[2] == 0.7
    backward = servo(-0.5)
    backward.gear[0] = -3.0
    _gear_down(backward)
    assert backward.ctrlrange == [-2.0, 1.0]
    assert backward.gainprm[0] == 18.0


def test_servos_of_a_world_are_as_asked_for():
    made = setup(servo_stiffness=123.0, servo_damping=4.5)
    model = made.model
    for joint in made.robot.card.joints:
        (servo,) = actuators_of(model, joint)
        assert model.actuator_gainprm[servo, 0] == 123.0
        assert model.actuator_biasprm[servo, 1] == -123.0
        assert model.actuator_biasprm[servo, 2] == -4.5
    assert common_servo(model, made.robot) == (123.0, 4.5)
    strong = setup(servo="mg996r", robot="hexapod-classroom", servo_data=None)
    torque = strong.servo.torque
    ranges = strong.model.actuator_forcerange
    assert ranges[:, 1] == pytest.approx(np.full(len(ranges), torque), rel=1e-5)
    assert ranges[:, 0] == pytest.approx(-ranges[:, 1])
    other = model.__copy__()
    other.actuator_gainprm[0, 0] += 1
    assert common_servo(other, made.robot) is None


def test_commands_and_angles_of_groups_are_inverse(hexapod):
    made = setup()
    groups = len(made.robot.groups)
    swing = np.array([[0.1, -0.2], [0.3, 0.05]])[:, :groups]
    targets = made.robot.targets(swing, np.zeros_like(swing))
    ctrl = made.channels.ctrl(targets)
    assert ctrl.shape == (2, made.model.nu)
    qpos = np.tile(made.model.key("start").qpos, (2, 1))
    for joint in made.robot.card.joints:
        (servo,) = actuators_of(made.model, joint)
        qpos[:, made.model.joint(joint).qposadr[0]] = ctrl[:, servo]
    assert made.channels.swing(qpos) == pytest.approx(swing)


def test_joints_swing_for_long_below_half_of_critical_damping(hexapod):
    """Where they got a new rotor; others only if nothing damps them at all."""
    asked = plain()
    assert undamped_joints(hexapod, asked) == ()
    assert undamped_joints(hexapod, plain(damping=1.0)) == ()
    assert undamped_joints(hexapod, plain(damping_ratio=1.0)) == ()
    model = hexapod.model
    joint = hexapod.card.joints[0]
    share = inertia_share(hexapod, model, [joint])
    dof = model.joint(joint).dofadr[0]
    least = inertia_share(hexapod, model, hexapod.card.joints)
    assert share >= least > 0
    assert share / least == pytest.approx(
        model.dof_M0[dof]
        / min(model.dof_M0[model.joint(j).dofadr[0]] for j in hexapod.card.joints)
    )


@pytest.mark.parametrize(("tilt", "floor"), [(0.9 * LEVEL, True), (1.1 * LEVEL, False)])
def test_a_plane_that_leans_by_a_milliradian_is_no_floor(hexapod, tilt, floor):
    spec = hexapod.read()
    for sensor in list(spec.sensors):
        spec.delete(sensor)
    for geom in [g for g in spec.geoms if g.type == mujoco.mjtGeom.mjGEOM_PLANE]:
        spec.delete(geom)
    half = tilt / 2
    spec.worldbody.add_geom(
        name="ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 0.1],
        quat=[np.cos(half), np.sin(half), 0, 0], pos=[0, 0, -0.3],
        contype=EVERYTHING, conaffinity=EVERYTHING,
    )  # fmt: skip
    if floor:
        found = ensure_floor(spec, hexapod)
        assert (found.name, found.height) == ("ground", pytest.approx(-0.3))
        own = scene().geom("floor")
        assert spec.geom("ground").solref.tolist() == own.solref.tolist()
        feet = [spec.geom(name) for name in hexapod.card.feet]
        assert spec.geom("ground").priority == 1 + max(0, *(f.priority for f in feet))
    else:
        with pytest.raises(
            Exception, match="tilted by .* degrees.*a floor is horizontal"
        ):
            ensure_floor(spec, hexapod)


def test_bumps_reach_half_a_metre_around_the_path_in_cells_of_a_centimetre():
    made = setup(bumps=0.01, **{"path.goal": [0.3, 0.1, 0.0]})
    assert made.model.nhfield == 1
    size = made.model.hfield_size[0]
    assert size[:3] == pytest.approx([0.15 + FLOOR_MARGIN, 0.05 + FLOOR_MARGIN, 0.01])
    columns, rows = int(made.model.hfield_ncol[0]), int(made.model.hfield_nrow[0])
    assert (columns, rows) == (round(2 * size[0] / CELL), round(2 * size[1] / CELL))
    heights = made.model.hfield_data[: rows * columns]
    assert (heights.min(), heights.max()) == (0.0, 1.0)
    places = [
        g
        for g in range(made.model.ngeom)
        if made.model.geom_type[g] == mujoco.mjtGeom.mjGEOM_HFIELD
    ]
    (place,) = places
    assert made.model.geom_pos[place] == pytest.approx([0.15, 0.05, -0.01])


@pytest.mark.parametrize("height", [0.12, 0.3])
def test_walls_reach_from_below_the_floor_to_their_height(height):
    wall = {
        "kind": "box",
        "center": [0.6, 0.5],
        "size": [0.2, 0.1],
        "yaw": 0.3,
        "height": height,
    }
    model = setup(obstacles=[wall]).model
    geom = model.geom("obstacle_1_1")
    assert geom.size == pytest.approx([0.1, 0.05, (height + SUNK) / 2])
    assert geom.pos == pytest.approx([0.6, 0.5, (height - SUNK) / 2])
    assert geom.quat == pytest.approx([np.cos(0.15), 0, 0, np.sin(0.15)])
    corners = [[0.5, 0.4], [0.9, 0.4], [0.6, 0.8]]
    prism = setup(
        obstacles=[{"kind": "polygon", "points": corners, "height": height}]
    ).model
    vertices = prism.mesh_vert + prism.geom("obstacle_1_1").pos
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, prism.geom("obstacle_1_1").quat)
    vertices = prism.mesh_vert @ turn.reshape(3, 3).T + prism.geom("obstacle_1_1").pos
    assert (vertices[:, 2].min(), vertices[:, 2].max()) == pytest.approx(
        (-SUNK, height)
    )


def test_touches_are_counted_as_they_begin_over_all_pieces():
    names = ["obstacle_1_1", "obstacle_1_2", "other"]
    sensors = [SimpleNamespace(name=n, adr=[k]) for k, n in enumerate(names)]
    model = SimpleNamespace(nsensor=3, sensor=lambda i: sensors[i])
    touches = Touches(model)
    touches.read(np.array([[1, 0, 1], [1, 1, 0], [0, 1, 1]], dtype=float))
    assert touches.count == 2
    touches.read(np.array([[1, 1, 1], [0, 0, 0], [0, 1, 0]], dtype=float))
    assert touches.count == 4


def test_angles_of_joints_add_those_of_loose_parts():
    made = setup(backlash=0.02)
    joint = made.robot.card.joints[3]
    qpos = np.zeros((2, made.model.nq))
    qpos[:, made.model.joint(joint).qposadr[0]] = [0.1, 0.2]
    qpos[:, made.model.joint("backlash_" + joint).qposadr[0]] = [0.01, -0.01]
    assert turned(made.model, qpos, [joint], "backlash_")[:, 0] == pytest.approx(
        [0.11, 0.19]
    )
    assert turned(made.model, qpos, [joint])[:, 0] == pytest.approx([0.1, 0.2])
    loose = made.model.joint("backlash_" + joint)
    assert loose.range == pytest.approx([-0.01, 0.01])


@pytest.mark.parametrize(("angle", "fine"), [(0.379, True), (0.382, False)])
def test_a_slope_is_held_below_the_angle_of_its_friction(angle, fine):
    """The tangent of 0.3805 rad is 0.4."""
    given = Scenario(
        name="s", segments=1, path=line((0.01, 0, 0)), slope=(angle, 0.7), friction=0.4
    )
    if fine:
        made = prepare(given)
        gravity = made.model.opt.gravity
        size = 9.81
        best = size * np.array(
            [np.sin(angle) * np.cos(0.7), np.sin(angle) * np.sin(0.7), -np.cos(angle)]
        )
        assert gravity == pytest.approx(best, rel=1e-5)
    else:
        with pytest.raises(
            UsageError, match="less than 0.381 rad, or give a friction above 0.40"
        ):
            prepare(given)
    assert replace(given, slope=None).slope is None
