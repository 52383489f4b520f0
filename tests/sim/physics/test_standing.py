"""A test that a robot stands, tried at a shorter timestep before it is refused."""

from dataclasses import replace

import mujoco
import pytest

from models import ModelError
from sim.physics.standing import _Standing, with_timestep
from sim.preparation.setup import prepare

EULER = mujoco.mjtIntegrator.mjINT_EULER
IMPLICIT = mujoco.mjtIntegrator.mjINT_IMPLICITFAST


@pytest.mark.physics
def test_a_shorter_timestep_is_tried_with_the_integrator_of_a_run_with_it(scenario):
    long = prepare(scenario(timestep=0.002)).model
    short = with_timestep(long, 0.0005)
    assert (long.opt.integrator, long.opt.timestep) == (IMPLICIT, 0.002)
    assert (short.opt.integrator, short.opt.timestep) == (EULER, 0.0005)
    run = prepare(scenario(timestep=0.0005)).model
    assert short.opt.integrator == run.opt.integrator


@pytest.mark.physics
def test_a_lift_servo_that_is_too_soft_bears_what_the_engine_says(scenario):
    setup = prepare(scenario())
    model, card = setup.model, replace(setup.robot.card, lift_angle=1e-6)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_step(model, data, nstep=500)
    standing = _Standing(replace(setup.robot, card=card), model, data)
    for leg, what in enumerate(standing.too_soft(), start=1):
        torque = abs(float(data.actuator(f"lift_{leg}").force[0]))
        assert f"joint 'lift_{leg}' bears {torque:.3g} N m" in what
    assert leg == 6


@pytest.mark.physics
def test_servos_too_weak_to_bear_the_robot_are_named_with_their_torque(scenario):
    """And not called too soft, since stiffer ones would give no more."""
    weak = {"servo": "mg90s", "servo_data": {"stall_torque": 0.01}}
    words = "servo of joint 'lift_1' gives no more than 0.01 N m: .*; give it stronger"
    with pytest.raises(ModelError, match=words):
        prepare(scenario(**weak))


def test_of_several_legs_in_the_air_the_first_is_named(scenario):
    setup = prepare(scenario())
    data = mujoco.MjData(setup.model)
    mujoco.mj_resetDataKeyframe(setup.model, data, setup.model.key("start").id)
    data.qpos[2] -= 1e-4  # the weight is on the floor
    for leg in (5, 2):
        data.joint(f"lift_{leg}").qpos += setup.robot.raise_sign[leg - 1] * 0.3
    mujoco.mj_forward(setup.model, data)
    (what,) = _Standing(setup.robot, setup.model, data).aloft()
    assert what.startswith("the foot of leg 2 touches nothing")
