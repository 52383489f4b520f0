"""The integrator of a run, and where explicit steps are stable."""

import mujoco
import pytest

from models import ModelError
from models.library import load, shipped_robots
from sim.preparation.setup import prepare
from sim.world.model import build, explicitness, suitable_integrator

STABLE = 1.9  # of `explicitness`, whose limit is 2 where the robot starts

EULER = mujoco.mjtIntegrator.mjINT_EULER
IMPLICIT = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
SWINGING = """
<mujoco>
  <option gravity="0 0 0" timestep="0.001"/>
  <worldbody>
    <body>
      <joint name="hinge" axis="0 0 1" stiffness="{spring}" damping="{rubbed}"/>
      <geom size="0.01" pos="0.1 0 0" mass="0.1"/>
    </body>
  </worldbody>
  <actuator><position joint="hinge" kp="{kp}" kv="{kv}" gear="2"/></actuator>
  <keyframe><key name="start"/></keyframe>
</mujoco>
"""


def swinging(spring=0.0, rubbed=0.0, kp=0.0, kv=0.0):
    text = SWINGING.format(spring=spring, rubbed=rubbed, kp=kp, kv=kv)
    return mujoco.MjModel.from_xml_string(text)


def test_one_joint_has_the_number_of_the_textbook():
    """(h c + h^2 k / 2) / I, with a gear's square; its own damping is implicit."""
    model = swinging(spring=100.0, rubbed=3.0, kp=50.0, kv=0.2)
    inertia = 0.1 * 0.1**2 + 0.4 * 0.1 * 0.01**2
    expected = (1e-3 * 4 * 0.2 + 0.5e-6 * (100 + 4 * 50)) / inertia
    assert explicitness(model) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("factor", [0.97, 1.03])
def test_eulers_integrator_diverges_from_two_on(factor):
    kv = 0.2 * factor * 2.0 / explicitness(swinging(kp=50.0, kv=0.2))
    model = swinging(kp=50.0 * kv / 0.2, kv=kv)
    model.opt.integrator = EULER
    data = mujoco.MjData(model)
    data.qvel[0] = 1e-3
    mujoco.mj_step(model, data, nstep=200)
    assert (abs(data.qvel[0]) > 1) == (factor > 1)


@pytest.mark.parametrize("name", shipped_robots())
def test_shipped_robots_are_integrated_by_euler(name, scenario):
    model = prepare(scenario(), load(name)).model
    assert explicitness(model) < STABLE
    assert model.opt.integrator == EULER


def test_stiff_servos_and_long_steps_are_integrated_implicitly(scenario):
    for changes in ({"servo_stiffness": 5000.0}, {"timestep": 0.002}):
        model = prepare(scenario(**changes)).model
        assert explicitness(model) > STABLE
        assert model.opt.integrator == IMPLICIT == suitable_integrator(model)


@pytest.mark.physics
def test_standing_feet_slip_less_with_euler(scenario):
    """The implicit integrator's slip grows with the timestep, and Euler's does not."""
    from sim.preparation.shared import Shared
    from sim.simulation import simulate

    def slip(timestep, integrator):
        shared, asked = Shared(), scenario(timestep=timestep, segments=1)
        model = prepare(asked, shared=shared).model
        model.opt.integrator = integrator
        walk = simulate(
            asked, without=("identified", "compliant", "creep_floor"), shared=shared
        )
        return walk.summary["achieved"]["slip"]

    fine = slip(0.00025, EULER)
    assert slip(0.001, EULER) == pytest.approx(fine, rel=0.01)
    assert slip(0.001, IMPLICIT) > 1.03 * fine


def test_a_storm_that_overflows_is_a_bad_model(edited, scenario):
    storm = '<option wind="1e300 0 0" density="1.2"/><worldbody>'
    with pytest.raises(ModelError, match="not finite: .*; give smaller .* wind"):
        build(edited("<worldbody>", storm), scenario())
