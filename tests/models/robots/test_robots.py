"""The contract every shipped robot keeps."""

import itertools

import mujoco
import numpy as np
import pytest

from models.contact.kinematics import Kinematics
from models.description.card_file import parse_card
from models.description.robot import FOLDER
from models.errors import ModelError, UnknownRobotError
from models.library import load, shipped_robots
from models.morphology.mjcf import write_mjcf
from models.morphology.shipped import MORPHOLOGIES


@pytest.fixture(params=shipped_robots(), scope="module")
def robot(request):
    return load(request.param)


@pytest.mark.parametrize("shape", MORPHOLOGIES, ids=lambda shape: shape.name)
def test_files_are_written_from_the_morphology(shape):
    path = FOLDER / f"{shape.name}.xml"
    groups = parse_card(path.with_suffix(".toml").read_text(), "a card").groups.values()
    assert path.read_text() == write_mjcf(shape, [group.legs for group in groups])


@pytest.mark.parametrize("shape", MORPHOLOGIES, ids=lambda shape: shape.name)
def test_feet_hips_and_mass_are_where_the_morphology_says(shape):
    robot = load(shape.name)
    stance = Kinematics(robot).standing
    feet = [shape.legs[leg].foot for leg in robot.legs]
    hips = [robot.model.body(f"leg_{leg}").pos[:2] for leg in robot.legs]
    # twelve digits are written
    assert stance.feet == pytest.approx(np.array(feet), abs=1e-11)
    assert np.array(hips) == pytest.approx(
        np.array([shape.legs[leg].hip for leg in robot.legs]), abs=1e-11
    )
    assert stance.height == pytest.approx(0.0, abs=1e-11)
    mass = shape.body_mass + shape.leg_mass * len(shape.legs)
    assert robot.model.body_mass.sum() == pytest.approx(mass)


def test_every_joint_foot_camera_and_sensor_is_named(robot):
    model = robot.model
    for count, kind in (
        (model.njnt, model.joint),
        (model.nu, model.actuator),
        (model.ncam, model.camera),
        (model.nsensor, model.sensor),
        (model.ngeom, model.geom),
    ):
        assert all(kind(i).name for i in range(count))
    assert {model.camera(i).name for i in range(model.ncam)} == {"top", "side", "chase"}
    assert model.nu == 2 * len(robot.legs)


def test_every_leg_joint_has_a_position_servo_within_its_range(robot):
    model = robot.model
    for i in range(model.nu):
        joint = model.actuator_trnid[i, 0]
        assert model.actuator(i).name == model.joint(joint).name
        assert model.actuator_biasprm[i, 1] == -model.actuator_gainprm[i, 0] < 0
        assert model.actuator_ctrlrange[i] == pytest.approx(model.jnt_range[joint])


def test_the_robot_stands_still_at_its_keyframe(robot):
    model = robot.model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    begin = data.qpos[:3].copy()
    mujoco.mj_step(model, data, nstep=1000)
    # the servos' sag: a third of the weight on one leg is 0.3 mm at most
    assert data.qpos[:3] == pytest.approx(begin, abs=1e-3)


def test_legs_clear_each_other_wherever_their_groups_swing(robot):
    model, legs = robot.model, range(len(robot.legs))
    data = mujoco.MjData(model)
    parts = ("hip", "femur", "tibia", "foot")
    geoms = [[model.geom(f"{part}_{leg}").id for part in parts] for leg in robot.legs]
    pairs = [
        (g, h) for a in legs for b in legs if a < b for g in geoms[a] for h in geoms[b]
    ]
    spans = [np.linspace(*robot.swing_range[group], 3) for group in robot.groups]
    for swing in itertools.product(*spans):
        data.qpos[:] = robot.start_qpos
        for leg, of, gain in zip(
            robot.legs, robot.group_of_leg, robot.swing_gain, strict=True
        ):
            data.joint(robot.card.legs[leg].swing).qpos += gain * swing[of]
        mujoco.mj_kinematics(model, data)
        for g, h in pairs:
            gap = mujoco.mj_geomDistance(model, data, g, h, 1.0, None)
            assert gap > 0, (swing, model.geom(g).name, model.geom(h).name)


def test_kinematics_agree_with_the_engine_at_any_angles(robot):
    rng = np.random.default_rng(1)
    kinematics, model = Kinematics(robot), robot.model
    data = mujoco.MjData(model)
    for _ in range(20):
        swing = rng.uniform(-0.45, 0.45, len(robot.groups))
        lift = rng.uniform(0, 0.5, len(robot.groups))
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        for leg, of, gain in zip(
            robot.legs, robot.group_of_leg, robot.swing_gain, strict=True
        ):
            card = robot.card.legs[leg]
            data.joint(card.swing).qpos += gain * swing[of]
            data.joint(card.lift).qpos += card.raise_sign * lift[of]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        stance = kinematics.stance(swing, lift)
        feet = np.array(
            [data.geom(robot.card.legs[n].foot[0]).xpos for n in robot.legs]
        )
        # the same kinematics in another arrangement: rounding alone
        assert stance.feet == pytest.approx(feet[:, :2], abs=1e-12)
        root = model.body(robot.root).id
        assert stance.center_of_mass == pytest.approx(
            data.subtree_com[root][:2], abs=1e-12
        )


def test_rates_of_the_feet_are_their_derivatives_by_the_group_angle(robot):
    kinematics, step = Kinematics(robot), 1e-6
    swing = np.random.default_rng(2).uniform(-0.4, 0.4, (5, len(robot.groups)))
    lift = np.full_like(swing, 0.1)
    ahead = kinematics.stance(swing + step, lift).feet
    behind = kinematics.stance(swing - step, lift).feet
    rates = kinematics.stance(swing, lift).rates
    # central differences: step^2 / 6 of a leg's length, and rounding over the step
    assert rates == pytest.approx((ahead - behind) / (2 * step), abs=1e-9)


def test_loading_an_unknown_name_lists_the_shipped_ones():
    with pytest.raises(
        UnknownRobotError,
        match=r"unknown robot: 'hexapop'; did you mean 'hexapod'\? shipped are hex",
    ):
        load("hexapop")


def test_a_missing_file_is_named():
    with pytest.raises(UnknownRobotError, match="no such robot file: nowhere.xml"):
        load("nowhere.xml")


def test_a_robot_may_be_named_by_a_path(tmp_path):
    for name in ("scene.xml", "hexapod.xml", "hexapod.toml"):
        (tmp_path / name).write_text((FOLDER / name).read_text())
    file = tmp_path / "hexapod.xml"
    assert load(file).text == load(str(file)).text
    with pytest.raises(TypeError, match="expected str, bytes or os.PathLike object"):
        load(3)


def test_a_file_that_is_no_mjcf_is_refused_in_one_line(tmp_path):
    path = tmp_path / "broken.xml"
    path.write_text("<mujoco><worldbody><geom sizee='1'/></worldbody></mujoco>")
    path.with_suffix(".toml").write_text((FOLDER / "hexapod.toml").read_text())
    with pytest.raises(ModelError, match="not a usable MJCF file.*sizee") as refusal:
        load(str(path))
    assert "\n" not in str(refusal.value)
