"""Servos with dead bands: their torque, their motors that go on braking, and draws."""

import mujoco
import numpy as np
import pytest

from sim.drive.drive import Drive
from sim.errors import UsageError
from sim.motion.schedule import Scheduler
from sim.preparation.setup import prepare
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from sim.world.dead_bands import BAND, dead_bands
from sim.world.imperfections import BACKLASH
from sim.world.model import build, load


@pytest.fixture(scope="module")
def standing():
    def make(**changes):
        given = {"name": "short", "segments": 2, "path": line((0.01, 0.01, 0.0))}
        return prepare(Scenario(**given | changes))

    return make


def _hold(setup):
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(0.01)
    return scheduler.finish()


@pytest.mark.parametrize("width", [0.02, 0.002])
def test_the_torque_of_a_step_is_all_of_the_stiffness_times_the_error(standing, width):
    stiffness = 50.0
    given = {"servo_stiffness": stiffness, "dead_band_law": "step"}
    setup = standing(dead_band=width, **given)
    model, data = setup.model, mujoco.MjData(setup.model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    data.ctrl = next(iter(Drive(setup).commands(_hold(setup), None)))[-1]
    mujoco.mj_step(model, data, nstep=2000)
    for leg in range(1, 7):
        servos = [data.actuator(f"{part}lift_{leg}") for part in ("", "step_")]
        torque = abs(sum(float(servo.force[0]) for servo in servos))
        names = f"lift_{leg}", f"{BAND}lift_{leg}"
        told = float(servos[0].ctrl[0])
        error = abs(sum(float(data.joint(name).qpos[0]) for name in names) - told)
        # less than the stiffness times half the band holds it at the band's edge, which
        # is as steep as the second spring; on stops the light spring bounces by 1 mrad.
        # The law `offset` would have 14.2 mrad with a torque of 0.21 N m
        steep = float(model.actuator(f"step_lift_{leg}").gainprm[0])
        least = max(width / 2, torque / stiffness)
        assert least - 1e-4 <= error <= least + torque / steep + 1e-3


def test_a_motor_brakes_its_joint_within_its_dead_band(standing):
    def speed_left(**given):
        """Of a leg that turns in the air within its slack, after 20 ms, as a share."""
        model = standing(robot="hexapod-classroom", **given).model
        model.opt.gravity[:] = 0
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        data.qpos[2] += 1.0
        loose = BAND if "dead_band" in given else BACKLASH
        data.joint(f"{loose}swing_1").qvel = 0.1
        mujoco.mj_step(model, data, nstep=20)
        names = ("swing_1", f"{loose}swing_1")
        return sum(float(data.joint(name).qvel[0]) for name in names) / 0.1

    # critical damping of 0.1 N m s/rad on 0.00025 kg m^2 stops it in 2.6 ms
    assert abs(speed_left(dead_band=0.05)) < 0.02
    assert speed_left(backlash=0.05) > 0.2


def test_a_joints_own_damping_stays_beside_its_dead_band(scenario, edited):
    def braking(*edits):
        model = load(build(edited(*edits), scenario(dead_band=0.01)))
        return np.ravel(model.tendon_damping[model.tendon("brake_swing_1").id])[0]

    own = braking('class="swing" name', 'class="swing" damping="0.3" name') - braking()
    # but for the share of braking that stands on the light joints of the springs
    assert own == pytest.approx(0.3, rel=1e-5)


def test_dead_bands_are_drawn_servo_by_servo_within_their_spread(scenario):
    drawn = dead_bands(scenario(dead_band=0.01, dead_band_spread=0.2, draw=3), 12)
    assert 0.008 <= drawn.min() < 0.0095 < 0.0105 < drawn.max() <= 0.012
    again = dead_bands(scenario(dead_band=0.01, dead_band_spread=0.2, draw=3), 12)
    assert (drawn == again).all()
    assert (dead_bands(scenario(dead_band=0.01, draw=3), 12) == 0.01).all()


def test_a_dead_band_for_each_joint_is_asked_for(standing):
    with pytest.raises(UsageError, match="dead_band has 2 values for 12 joints"):
        standing(dead_band=[0.01, 0.02])
