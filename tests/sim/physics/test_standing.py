"""A test that a robot stands, tried at a shorter timestep before it is refused."""

import mujoco
import pytest

from sim.physics.standing import with_timestep
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
