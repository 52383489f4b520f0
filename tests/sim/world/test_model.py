"""The written model, and the settings in it."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models.description.robot import FOLDER
from models.errors import ModelError
from models.library import load as load_robot
from sim.world.model import _ctrl, build, load
from sim.world.sensors import contact_sensor
from sim.world.servos import Channels

BARE = """
<mujoco model="tricycle">
  <worldbody>
    <body name="trunk" pos="0 0 0.1">
      <freejoint/>
      <geom type="box" size="0.05 0.05 0.01" contype="0" conaffinity="0"/>
      {legs}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>
"""
LEG = """
      <body name="leg{n}" pos="{x} {y} 0" euler="0 0 {yaw}">
        <joint name="yaw{n}" axis="0 0 1" range="-40 40"/>
        <joint name="roll{n}" axis="0 -1 0" range="-20 60"/>
        <geom name="toe{n}" type="sphere" size="0.01" pos="0.1 0 -0.07"/>
      </body>
"""
CARD = """
lift_angle = 0.2
[leg]
1 = { swing = "yaw1", lift = "roll1", foot = ["toe1"] }
2 = { swing = "yaw2", lift = "roll2", foot = ["toe2"] }
3 = { swing = "yaw3", lift = "roll3", foot = ["toe3"] }
[group.1]
legs = { 1 = 1, 2 = 1, 3 = 1 }
[gait]
strata = ["1", "1"]
"""
SERVO = "[servo]\nstiffness = 50.0\ndamping = 0.5\n"


@pytest.fixture
def tricycle(tmp_path):
    """A robot without floor, servos, sensors or keyframe, driven by motors."""

    def make(card=CARD + SERVO):
        angles = np.deg2rad([60, 180, 300])
        legs = "".join(
            LEG.format(n=n, x=0.05 * np.cos(a), y=0.05 * np.sin(a), yaw=np.rad2deg(a))
            for n, a in enumerate(angles, start=1)
        )
        motors = "".join(
            f'<motor name="m_{j}{n}" joint="{j}{n}"/>'
            for j in ("yaw", "roll")
            for n in (1, 2, 3)
        )
        path = tmp_path / "tricycle.xml"
        path.write_text(BARE.format(legs=legs, motors=motors))
        path.with_suffix(".toml").write_text(card)
        return load_robot(str(path))

    return make


def test_the_text_loads_in_bare_mujoco_and_stands(hexapod, scenario):
    model = mujoco.MjModel.from_xml_string(build(hexapod, scenario()).text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    assert data.qpos[:2] == pytest.approx([0, 0])
    mujoco.mj_step(model, data, nstep=400)
    weight = model.body_subtreemass[0] * 9.81
    forces = [
        data.sensor(contact_sensor(f"foot_{leg}")).data[1] for leg in hexapod.legs
    ]
    # settled to a per cent after 0.2 s of critically damped servos
    assert sum(forces) == pytest.approx(weight, rel=0.01)


def test_settings_reach_the_model(hexapod, scenario):
    wanted = scenario(
        timestep=0.0004, friction=0.6, servo_stiffness=120.0, servo_damping=0.7
    )
    model = load(build(hexapod, wanted))
    assert model.opt.timestep == 0.0004
    assert model.geom("floor").friction[0] == model.geom("foot_3").friction[0] == 0.6
    assert (model.actuator_gainprm[:, 0] == 120.0).all()
    assert (model.actuator_biasprm[:, 1] == -120.0).all()
    assert (model.actuator_biasprm[:, 2] == -0.7).all()


def test_servos_keep_their_own_damping_when_only_stiffness_is_set(hexapod, scenario):
    own = load(build(hexapod, scenario()))
    model = load(build(hexapod, scenario(servo_stiffness=120.0)))
    assert (model.actuator_gainprm[:, 0] == 120.0).all()
    assert model.actuator_biasprm[:, 2] == pytest.approx(own.actuator_biasprm[:, 2])


def test_a_robot_without_memory_for_its_contacts_is_refused(tricycle, scenario):
    robot = tricycle()
    path = robot.path.with_name("small.xml")
    small = robot.path.read_text().replace(
        "<worldbody", '<size memory="4K"/><worldbody'
    )
    path.write_text(small)
    path.with_suffix(".toml").write_text(robot.path.with_suffix(".toml").read_text())
    with pytest.raises(ModelError, match=r"small.xml; .*increase <size memory") as why:
        build(load_robot(str(path)), scenario())
    assert "\n" not in str(why.value)


def test_the_solver_is_set_for_slip_to_mean_something(hexapod, scenario):
    option = load(build(hexapod, scenario())).opt
    assert option.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert option.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
    assert option.impratio == 10000


def test_dense_and_sparse_factorisations_agree_on_a_standing_robot(hexapod, scenario):
    ends = []
    for jacobian in (mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtJacobian.mjJAC_SPARSE):
        model = load(build(hexapod, scenario()))
        model.opt.jacobian = jacobian
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        data.ctrl[:] = 0.1
        mujoco.mj_step(model, data, nstep=500)
        ends.append(data.qpos.copy())
    # the same equations in another order: rounding, grown through contacts
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


def test_the_same_scenario_writes_the_same_text(hexapod, scenario):
    assert build(hexapod, scenario()) == build(hexapod, scenario())


def test_a_bare_robot_gets_floor_servos_sensors_and_keyframe(tricycle, scenario):
    robot = tricycle()
    model = load(build(robot, scenario()))
    assert model.geom("scene_floor").type == mujoco.mjtGeom.mjGEOM_PLANE
    assert sorted(model.actuator(i).name for i in range(model.nu)) == [
        "roll1", "roll2", "roll3", "yaw1", "yaw2", "yaw3",
    ]  # fmt: skip
    assert (model.actuator_gainprm[:, 0] == 50.0).all()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    assert data.geom("toe1").xpos[2] == pytest.approx(0.01, abs=1e-9)
    assert model.sensor("center_of_mass").dim == 3


def test_a_joint_without_a_servo_needs_one_on_the_card(tricycle, scenario):
    with pytest.raises(
        ModelError, match=r"joint 'yaw1' has no position servo.*\[servo\]"
    ):
        build(tricycle(card=CARD), scenario())


def test_commands_turn_and_raise_every_leg_of_a_group(hexapod, scenario):
    model = load(build(hexapod, scenario()))
    ctrl = Channels(hexapod, model).ctrl(
        hexapod.targets(np.array([[0.1, -0.2]]), np.array([[0.3, 0.0]]))
    )[0]
    for leg in (1, 4, 5):
        assert ctrl[model.actuator(f"swing_{leg}").id] == -0.1  # clockwise from above
        assert ctrl[model.actuator(f"lift_{leg}").id] == 0.3
    for leg in (2, 3, 6):
        assert ctrl[model.actuator(f"swing_{leg}").id] == -0.2
        assert ctrl[model.actuator(f"lift_{leg}").id] == 0.0


def test_the_shipped_scene_has_no_robot_in_it():
    scene = mujoco.MjModel.from_xml_path(str(FOLDER / "scene.xml"))
    assert (scene.nbody, scene.nq, scene.nu) == (1, 0, 0)


def test_actuators_keep_what_the_robot_s_file_tells_them_unless_they_move_a_leg(
    hexapod,
):
    """One that was added, of which the file knows nothing, is told nothing."""
    leg, other = hexapod.card.joints[0], "antenna"
    joint = mujoco.mjtTrn.mjTRN_JOINT
    told = {"servo": 0.7, "feeler": 0.8, "cable": 0.9}
    names = [*told]
    robot = SimpleNamespace(
        model=SimpleNamespace(actuator=lambda i: SimpleNamespace(name=names[i])),
        start_data=SimpleNamespace(ctrl=told.values()),
        card=SimpleNamespace(joints=[leg]),
        standing_angle=lambda name: {leg: 0.25}[name],
    )
    actuators = [
        SimpleNamespace(name=name, target=target, trntype=kind)
        for name, target, kind in (
            ("servo", leg, joint),
            ("feeler", other, joint),
            ("cable", leg, mujoco.mjtTrn.mjTRN_TENDON),
            ("spring", leg, mujoco.mjtTrn.mjTRN_SITE),
        )
    ]
    assert _ctrl(SimpleNamespace(actuators=actuators), robot) == [0.25, 0.8, 0.9, 0.0]
