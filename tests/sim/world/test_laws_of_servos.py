"""Servos of a file pull in a walk as the file has it, whatever says so there."""

import shutil

import mujoco
import pytest

from models import ModelError, load
from models.description import FOLDER
from sim.scenarios.file import load_scenario
from sim.world.model import build
from sim.world.motors import undamped_joints
from sim.world.servos import servo_settings

SWINGS = '<position kp="1000" kv="2.81424945589" ctrlrange="-0.45 0.45"/>'
DAMPED = '<position kp="1000" kv="2.8" damping="5 0.3"/>'
GEARED = '<position kp="10" kv="0.028" gear="10" damping="0.05 3e-4" armature="1e-5"/>'


def with_swings(folder, law):
    """The hexapod with other servos of its swings."""
    text = (FOLDER / "hexapod.xml").read_text()
    assert SWINGS in text
    if law.startswith("<general"):
        text = text.replace('<position class="swing"', '<general class="swing"')
    folder.mkdir(exist_ok=True)
    (folder / "r.xml").write_text(text.replace(SWINGS, law))
    shutil.copy(FOLDER / "hexapod.toml", folder / "r.toml")
    shutil.copy(FOLDER / "scene.xml", folder)
    return load(str(folder / "r.xml"))


def walked(robot, **settings):
    world = build(robot, load_scenario("line", {"robot": str(robot.path), **settings}))
    return mujoco.MjModel.from_xml_string(world.text, dict(world.assets))


def torque(model, angle, speed):
    """At a swing joint that is told to go to 0 [N m]."""
    data, joint = mujoco.MjData(model), model.joint("swing_1")
    data.joint("swing_1").qpos, data.joint("swing_1").qvel = angle, speed
    mujoco.mj_forward(model, data)
    dof = joint.dofadr[0]
    return data.qfrc_actuator[dof] + data.qfrc_passive[dof]


@pytest.mark.parametrize("law", [SWINGS, DAMPED, GEARED])
@pytest.mark.parametrize("state", [(0.1, 0.0), (0.0, 1.0), (-0.1, -2.0)])
def test_a_servo_pulls_in_a_walk_as_in_its_file(tmp_path, law, state):
    robot = with_swings(tmp_path, law)
    assert torque(walked(robot), *state) == pytest.approx(torque(robot.model, *state))


@pytest.mark.parametrize("law", [DAMPED, GEARED])
def test_a_damping_that_is_asked_for_is_all_that_there_is(tmp_path, law):
    model = walked(with_swings(tmp_path, law), servo_damping=1.0)
    assert torque(model, 0.0, 2.0) == pytest.approx(-2.0)


@pytest.mark.parametrize(
    "law",
    [
        '<general gainprm="1000" biastype="none" biasprm="0 -1000 -2.8"/>',
        '<general gaintype="affine" gainprm="1000 -3000 0" biastype="affine" '
        'biasprm="0 -1000 -2.8"/>',
    ],
    ids=["no bias", "a gain with a slope"],
)
def test_what_is_no_position_servo_is_not_walked_as_one(tmp_path, law):
    """It is a motor, for which this card has no servo."""
    robot = with_swings(tmp_path, law)
    with pytest.raises(ModelError, match="'swing_1'"):
        walked(robot)


def test_rotors_of_motors_stay_on_their_joints(tmp_path):
    """The motors themselves give way to the servos."""
    plain = with_swings(tmp_path / "plain", SWINGS)
    spec = plain.read()
    for joint in plain.swing_joints:
        motor = spec.add_actuator(name=f"motor of {joint}", target=joint)
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
        motor.armature, motor.gear[0] = 1e-5, 10.0
    robot = with_swings(tmp_path / "motors", SWINGS)
    robot.path.write_text(spec.to_xml())
    dof = robot.model.joint("swing_1").dofadr[0]
    found, base = (walked(load(str(one.path))).dof_M0[dof] for one in (robot, plain))
    assert found - base == pytest.approx(1e-3, rel=1e-3)
    robot.path.write_text(spec.to_xml().replace('armature="0.0018"', ""))
    lifts = {leg.lift for leg in robot.leg_cards}
    assert {*load(str(robot.path)).joints_without_rotor} == lifts


FAINT = '<position kp="10" kv="0" gear="10" damping="1e-4"/>'  # 0.003 of the critical


@pytest.mark.parametrize("law", [GEARED, FAINT])
def test_a_servo_behind_a_gear_is_damped_as_its_equal_on_the_joint(tmp_path, law):
    """By its own damping or that of its gears; a gear of 10 multiplies it by 100."""
    robot = with_swings(tmp_path, law)
    settings = servo_settings(load_scenario("line"), robot.card)
    assert undamped_joints(robot, settings) == ()
    weak = FAINT.replace("1e-4", "1e-6")
    loose = undamped_joints(with_swings(tmp_path, weak), settings)
    assert {*loose} == {*robot.swing_joints}
