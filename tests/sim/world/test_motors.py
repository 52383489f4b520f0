"""What owners leave out of their files: rotors, damping, and names of servos."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.library import load
from sim.preparation.setup import prepare
from sim.world import motors
from sim.world.changes import changes
from tests import owners
from tests.walks import simulated


def owned(write, folder):
    """A robot as `adopt` leaves it."""
    source = source_of(str(write(folder)))
    if source.text is not None:
        source.path.write_text(source.text)
    source.path.with_suffix(".toml").write_text(draft_card(source).card)
    return load(str(source.path))


@pytest.fixture(scope="module")
def handmade(tmp_path_factory):
    return owned(owners.handmade, tmp_path_factory.mktemp("handmade"))


def of_joints(robot, model):
    """Armature and damping ratio of the leg joints, shape (J,) each."""
    dofs = [model.joint(joint).dofadr[0] for joint in robot.card.joints]
    servos = [model.actuator(joint).id for joint in robot.card.joints]
    stiffness, damping = model.actuator_gainprm[:, 0], -model.actuator_biasprm[:, 2]
    critical = 2 * np.sqrt(stiffness[servos] * model.dof_M0[dofs])
    return model.dof_armature[dofs], damping[servos] / critical


def test_joints_without_rotors_get_those_of_motors_that_could_carry_the_robot(
    handmade, scenario
):
    armature, ratio = of_joints(handmade, prepare(scenario(), handmade).model)
    # 0.0051 s^2 times a third of 4.4 N at 0.12 m, less what the lightest joint has
    assert armature == pytest.approx(8.4e-4, rel=0.02)
    assert ratio == pytest.approx(1.0, rel=0.02)
    rotors, damped = changes(handmade, scenario())
    assert "joints 'h1', 'k1', 'h2', ... have no armature" in rotors
    assert "0.00084 kg m^2" in rotors
    assert "'h1', 'k1', 'h2', ... have no damping, or little" in damped


def test_a_make_brings_its_own_rotor(handmade, scenario):
    given = scenario(servo="mg90")
    armature, ratio = of_joints(handmade, prepare(given, handmade).model)
    assert armature == pytest.approx(240**2 * 4e-9)
    assert ratio == pytest.approx(1.0, rel=0.05)  # the compiler's, at the file's zero
    (rotors,) = changes(handmade, given)
    assert "0.00023 kg m^2" in rotors


def test_rotors_and_damping_that_a_file_gives_are_kept(tmp_path, scenario):
    path = owners.handmade(tmp_path)
    text = path.read_text().replace("<joint ", '<joint armature="1e-4" damping="0.02" ')
    robot = owned(lambda _: path if path.write_text(text) else path, tmp_path)
    model = prepare(scenario(), robot).model
    armature, ratio = of_joints(robot, model)
    assert (armature == 1e-4).all()
    assert (ratio == 0).all()
    assert not [*changes(robot, scenario())]


def test_a_fitting_motor_turns_its_rotor_at_700_rad_a_second_on_its_spring(
    hexapod, monkeypatch
):
    monkeypatch.setattr(motors, "servo_for", lambda _: SimpleNamespace(stiffness=49.0))
    own = hexapod.model.dof_M0[hexapod.model.joint("lift_1").dofadr[0]]
    share = motors.inertia_share(hexapod, hexapod.model, ["lift_1"])
    assert share == pytest.approx(own / (49.0 / 700.0**2))


def test_shipped_robots_have_rotors_of_their_own(hexapod, scenario):
    assert hexapod.joints_without_rotor == ()
    assert not [*changes(hexapod, scenario())]


def test_a_servo_without_a_name_is_called_after_its_joint(tmp_path, scenario):
    robot = owned(owners.mirrored, tmp_path)
    names = [robot.model.actuator(i).name for i in range(robot.model.nu)]
    assert names[:3] == ["first", "pitch_1", "yaw_2"]
    weak = scenario(servo="mg90", payload=(1.0, 0.0, 0.0, 0.0))
    model = prepare(weak, robot).model
    assert isinstance(model, mujoco.MjModel)
    assert model.actuator("pitch_6").trnid[0] == model.joint("pitch_6").id


@pytest.mark.physics
def test_feet_of_an_owner_s_robot_stay_where_they_are(handmade, scenario):
    given = scenario(robot=str(handmade.path), segments=1)
    summary = simulated(given).summary
    assert summary["bounces"] <= 2  # 0 measured; 21 on legs alone
    assert summary["error"]["quasi_static"]["position_per_path"] < 0.01


@pytest.mark.parametrize(
    ("settings", "most"),
    [({}, 0.7), ({"servo": "mg996r"}, 11 * 0.0980665)],
    ids=["as the file has it", "on another make"],
)
def test_torque_that_a_file_allows_joints_is_that_of_their_servos(
    tmp_path, scenario, settings, most
):
    handmade = owned(owners.handmade, tmp_path)
    text = handmade.path.read_text()
    limited = text.replace("<joint ", '<joint actuatorfrcrange="-0.7 0.7" ')
    assert limited != text
    handmade.path.write_text(limited)
    model = prepare(scenario(**settings), load(str(handmade.path))).model
    servos = [model.actuator(joint).id for joint in handmade.card.joints]
    assert model.actuator_forcelimited[servos].all()
    assert model.actuator_forcerange[servos] == pytest.approx(
        np.array([-most, most]) * np.ones((12, 1)),
        rel=1e-5,  # MJCF is written with six digits
    )
    assert not model.jnt_actfrclimited.any()


def test_servos_of_tendons_and_of_other_joints_keep_their_limits(monkeypatch, hexapod):
    leg, taken = hexapod.card.joints[0], []
    joint, tendon = mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_TENDON
    servos = [
        SimpleNamespace(trntype=kind, target=target, biasprm=[0, 0, 0])
        for kind, target in ((joint, leg), (tendon, leg), (joint, "antenna"))
    ]
    monkeypatch.setattr(motors, "added_rotors", lambda *_: {})
    monkeypatch.setattr(motors, "undamped_joints", lambda *_: {leg})
    monkeypatch.setattr(motors, "_take_limit", lambda servo, *_: taken.append(servo))
    spec = SimpleNamespace(actuators=servos, joint=lambda name: name)
    motors.ensure_motors(spec, hexapod, None)
    assert taken == servos[:1]
    assert [servo.biasprm[2] for servo in servos] == [motors.CRITICAL, 0, 0]


def test_springs_given_by_time_constants_stay_what_they_are_without_a_rotor(
    tmp_path, scenario
):
    path = owners.handmade(tmp_path)
    path.write_text(
        path.read_text().replace('name="k1"', 'name="k1" springdamper="1 1"')
    )
    robot = owned(lambda folder: path, tmp_path)
    own = robot.model.joint("k1")
    assert own.armature == 0 < own.stiffness[0]
    walked = prepare(scenario(), robot).model.joint("k1")
    assert walked.armature > 0
    assert walked.stiffness == pytest.approx(own.stiffness, rel=1e-5)  # as text
    assert walked.damping == pytest.approx(own.damping, rel=1e-5)
