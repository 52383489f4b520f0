"""Servos with dead bands: their torque, their motors that go on braking, and draws."""

import mujoco
import numpy as np
import pytest

from models import SERVO_KINDS
from models.description import actuators_of
from sim.errors import UsageError
from sim.export.served import served
from sim.export.source import from_scenario, play
from sim.preparation.setup import prepare
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from sim.world.dead_bands import band_in, dead_bands
from sim.world.imperfections import BACKLASH


@pytest.fixture(scope="module")
def standing():
    def make(**changes):
        given = {"name": "short", "segments": 2, "path": line((0.01, 0.01, 0.0))}
        return prepare(Scenario(**given | changes))

    return make


def _law(name, error, half, stiffness):
    """Torque of a servo by the definition of its dead band."""
    rest = error - np.clip(error, -half, half)
    return stiffness * (rest if name == "offset" else error * (rest != 0))


@pytest.mark.parametrize("law", ["offset", "step"])
@pytest.mark.parametrize("width", [0.02, 0.002])
def test_the_torque_is_that_of_the_law(standing, law, width):
    stiffness, edge = 50.0, width / 2
    given = {"servo_stiffness": stiffness, "dead_band_law": law}
    model = standing(dead_band=width, **given).model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    place = int(model.joint("lift_1").qposadr[0])
    servos, start = actuators_of(model, "lift_1"), float(data.qpos[place])
    assert band_in(model, "lift_1") == pytest.approx(width)
    # a step rises within a quarter of half the band beyond its edge
    for error in np.array([-3.0, -1.3, -0.9, 0.0, 0.5, 0.99, 1.3, 2.0]) * edge:
        data.qpos[place] = start - error
        mujoco.mj_forward(model, data)
        torque = data.actuator_force[servos].sum()
        assert torque == pytest.approx(_law(law, error, edge, stiffness), abs=1e-9)


@pytest.mark.parametrize("law", ["offset", "step"])
def test_a_servo_stalls_with_all_its_torque(standing, law):
    given = {"robot": "hexapod-classroom", "dead_band_law": law}
    model = standing(dead_band=0.0087, **given).model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    data.ctrl[actuators_of(model, "lift_1")] += 1.0
    mujoco.mj_forward(model, data)
    torque = data.actuator_force[actuators_of(model, "lift_1")].sum()
    assert torque == pytest.approx(SERVO_KINDS["mg90"].stall_torque)


def test_a_motor_brakes_its_joint_within_its_dead_band(standing):
    def speed_left(loose, **given):
        """Of a leg that turns in the air within its slack, after 20 ms, as a share."""
        model = standing(robot="hexapod-classroom", **given).model
        model.opt.gravity[:] = 0
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        data.qpos[2] += 1.0
        data.joint(f"{loose}swing_1").qvel = 0.1
        mujoco.mj_step(model, data, nstep=20)
        names = {"swing_1", f"{loose}swing_1"}
        return sum(float(data.joint(name).qvel[0]) for name in names) / 0.1

    # critical damping of 0.1 N m s/rad on 0.00025 kg m^2 stops it in 2.6 ms
    assert abs(speed_left("", dead_band=0.05)) < 0.02
    assert speed_left(BACKLASH, backlash=0.05) > 0.2


def test_dead_bands_are_drawn_servo_by_servo_within_their_spread(scenario):
    drawn = dead_bands(scenario(dead_band=0.01, dead_band_spread=0.2, draw=3), 12)
    assert 0.008 <= drawn.min() < 0.0095 < 0.0105 < drawn.max() <= 0.012
    again = dead_bands(scenario(dead_band=0.01, dead_band_spread=0.2, draw=3), 12)
    assert (drawn == again).all()
    for none in (0.0, -0.0):  # which `--set` takes for a number from 0
        alike = scenario(dead_band=0.01, dead_band_spread=none, draw=3)
        assert (dead_bands(alike, 12) == 0.01).all()


def test_a_dead_band_for_each_joint_is_asked_for(standing):
    with pytest.raises(UsageError, match="there are 12 joints, and dead_band lists 2"):
        standing(dead_band=[0.01, 0.02])


def test_the_band_of_the_make_is_asked_for_by_a_word(standing):
    own = standing(robot="hexapod-classroom", dead_band="own").scenario
    assert own.dead_band == SERVO_KINDS["mg90"].dead_band
    with pytest.raises(UsageError, match="servos are of no make"):
        standing(dead_band="own")


@pytest.mark.parametrize("law", ["offset", "step"])
def test_whatever_commands_a_joint_commands_the_springs_of_its_band(standing, law):
    """Experiments, exports and fits command joints; a spring left behind pulls back."""
    setup = standing(servo_stiffness=60.0, dead_band=0.02, dead_band_law=law)
    joints = setup.robot.card.joints
    asked = {joint: 0.01 * np.arange(3.0) + n for n, joint in enumerate(joints)}
    ctrl = setup.channels.ctrl(asked)
    for joint, angles in asked.items():
        driving = actuators_of(setup.model, joint)
        assert len(driving) == (2 if law == "offset" else 3)
        assert (ctrl[:, driving] == angles[:, None]).all()


@pytest.mark.physics
def test_an_exported_walk_of_servos_with_dead_bands_is_the_walk(standing):
    own = {"servo_stiffness": 60.0, "dead_band": 0.02, "command_rate": 50.0}
    setup = standing(**own, predictions=("ideal",))
    source = from_scenario(setup.scenario, setup.robot)
    played = play(source, source.commands(50.0))
    assert played.changed < 1e-9  # bit for bit, but for the sum of rounded times


@pytest.mark.physics
def test_a_walk_of_more_commands_than_steps_is_exported_a_command_a_step(standing):
    setup = standing(command_rate=5000.0, predictions=("ideal",))
    source = from_scenario(setup.scenario, setup.robot)
    commands = source.commands(60.0)
    assert commands.rate == pytest.approx(1000.0)
    assert play(source, commands).changed < 1e-9
    assert served(setup.scenario).rate == pytest.approx(1000.0)
