"""Places of a robot's parts agree with the engine's, for every robot there is."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from models import shipped_robots
from sim.compliant.places import rotation
from sim.compliant.prediction import phases_of
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario


@pytest.fixture(scope="module", params=sorted(shipped_robots()))
def posed(request):
    """Phases, engine and places of a robot in a tilted pose with bent legs."""
    setup = prepare(load_scenario("line", {"robot": request.param}))
    phases, model = phases_of(setup), setup.model
    anatomy, random = phases.mechanics.anatomy, np.random.default_rng(0)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    angles = anatomy.start + random.uniform(-0.3, 0.3, anatomy.start.shape)
    joints = model.actuator_trnid[anatomy.actuator, 0]
    data.qpos[model.jnt_qposadr[joints]] = angles
    v = np.array([0.1, -0.2, 0.3])
    at = setup.robot.root_address_in(model)
    length = np.linalg.norm(v)
    data.qpos[at + 3 : at + 7] = [np.cos(length / 2), *np.sin(length / 2) * v / length]
    mujoco.mj_forward(model, data)
    turned = rotation(v)[None]
    places = phases.mechanics.skeleton.places(phases.robots, turned, angles[None])
    return setup, phases, data, joints, turned, angles, places


def test_feet_and_centre_of_mass_are_the_engines(posed):
    setup, phases, data, _, turned, _, places = posed
    root = data.body(setup.robot.root)
    assert np.allclose(turned[0], root.xmat.reshape(3, 3), atol=1e-12)
    centre = data.subtree_com[setup.model.body(setup.robot.root).id]
    assert np.allclose(places.center[0], centre - root.xpos, atol=1e-12)
    for foot, card in enumerate(setup.robot.leg_cards):
        sphere = data.geom(card.foot[0])
        point = sphere.xpos - (0, 0, phases.robots.radius[0, foot, 0]) - root.xpos
        assert np.allclose(places.arm[0, foot, 0], point, atol=1e-12)


def test_weight_bends_joints_as_in_the_engine(posed):
    setup, phases, data, joints, _, _, places = posed
    found = places.weight_torque(phases.mechanics.anatomy, phases.robots.gravity)[0]
    dofs = setup.model.jnt_dofadr[joints]
    assert np.allclose(found, -data.qfrc_bias[dofs], atol=1e-12)


def test_levers_are_derivatives(posed):
    """Of what a foot touches with; a round one is taken without its radius here."""
    _, phases, _, _, turned, angles, _ = posed
    robot = replace(phases.robots, radius=0 * phases.robots.radius)
    skeleton, step = phases.mechanics.skeleton, 1e-6
    places = skeleton.places(robot, turned, angles[None])
    for foot, joint in np.ndindex(*angles.shape):
        nudged = angles.copy()
        nudged[foot, joint] += step
        moved = skeleton.places(robot, turned, nudged[None])
        rate = (moved.arm - places.arm)[0, foot].ravel() / step
        assert np.allclose(rate, places.lever[0, foot, :, joint], atol=1e-6)


@pytest.mark.parametrize("law", ["offset", "step"])
def test_a_dead_band_is_a_range_that_the_motor_brakes(law):
    given = {"robot": "hexapod-classroom", "dead_band": 0.0087, "dead_band_law": law}
    setup = prepare(load_scenario("line", given))
    phases, model = phases_of(setup), setup.as_planned.model
    robots = phases.robots
    braking = -model.actuator_biasprm[phases.mechanics.anatomy.actuator, 2]
    assert np.allclose(robots.slack, 0.0087, atol=1e-12)
    assert np.allclose(robots.rub[0], braking, rtol=1e-5)
