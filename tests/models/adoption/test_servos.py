"""Servos of drafts: stiff enough for half of the legs, critically damped."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models.adoption.anatomy import Pose, drafted_servo, find_limbs, servo_stiffness
from models.errors import ModelError

TEXT = """<mujoco><option gravity="0 0 -9.81"/><worldbody>
  <body name="trunk" pos="0 0 1"><freejoint/><geom size="0.1" mass="{mass}"/>
    <body pos="0.1 0 0"><joint name="a" axis="0 0 1" armature="{armature}"/>
      <geom size="0.02" pos="0.2 0 0" mass="0.3"/></body>
    <body pos="-0.1 0 0"><joint name="b" axis="0 0 1" armature="0.5"/>
      <geom size="0.02" pos="0.1 0 0" mass="0.3"/></body></body></worldbody>
  <actuator>{servos}</actuator></mujoco>"""


def pose(mass=4.0, armature=0.0, servos=""):
    text = TEXT.format(mass=mass, armature=armature, servos=servos)
    model = mujoco.MjModel.from_xml_string(text)
    return Pose.at(model, model.body("trunk").id, model.qpos0)


def own(mass, at, radius=0.02):
    """Inertia of a ball beside its hinge."""
    return mass * (at**2 + 0.4 * radius**2)


@pytest.mark.parametrize(("legs", "arm"), [(4, 0.2), (6, 0.1)])
def test_a_drafted_servo_holds_half_of_the_legs_up_and_follows_critically(legs, arm):
    found = drafted_servo(pose(), ["a", "b"], arm, legs)
    # a load of a half of the legs on an arm turns it by 1/2500 rad
    torque = (4.0 + 0.6) * 9.81 / (legs / 2) * arm
    assert found.stiffness == pytest.approx(2500 * torque)
    one, other = own(0.3, 0.2), own(0.3, 0.1) + 0.5
    # a rotor for the lightest to answer at 700 rad/s
    rotor = max(0.0, found.stiffness / 700**2 - min(one, other))
    assert found.armature == pytest.approx(rotor)
    inertia = (one + other) / 2 + rotor
    assert found.damping == pytest.approx(2 * np.sqrt(found.stiffness * inertia))


def test_heavy_legs_need_no_rotor_and_are_too_heavy_at_last():
    assert drafted_servo(pose(armature=0.5), ["a", "b"], 0.1, 6).armature == 0.0
    heavy = SimpleNamespace(model=pose().model, data=pose().data, root=1)
    heavy.model.body_subtreemass[1] = 1e307
    with pytest.raises(ModelError, match="^too heavy: 9.81e.307 N; correct masses"):
        drafted_servo(heavy, ["a", "b"], 0.1, 6)


@pytest.mark.parametrize(
    ("servos", "stiffness"),
    [
        ("", 0.0),
        ('<position joint="a" kp="30"/>', 30.0),
        ('<position joint="a" kp="30" gear="2"/>', 120.0),
        ('<position joint="b" kp="30"/>', 0.0),
        ('<motor joint="a"/>', 0.0),
        ('<motor joint="a"/><position joint="a" kp="7"/>', 7.0),
    ],
)
def test_a_servo_s_stiffness_is_that_at_the_joint(servos, stiffness):
    assert servo_stiffness(pose(servos=servos).model, "a") == stiffness


FEET = """<mujoco><worldbody>
  <body name="trunk" pos="0 0 1"><freejoint/><geom size="0.1"/>
  <body pos="0.1 0 0"><joint name="a" axis="0 0 {sign}1"/><geom size="0.02"/>
  <body pos="0.1 0 0"><joint name="b" axis="0 {sign}1 0"/>
    <geom name="near" size="0.02" pos="0 0 -0.1"/>
    <geom name="far" size="0.02" pos="0.1 0 -0.2"/>
    <geom name="mid" size="0.02" pos="0.05 0 -0.1"/></body></body>
  </body></worldbody></mujoco>"""


@pytest.mark.parametrize(("sign", "turn", "up"), [("", 1.0, -1.0), ("-", -1.0, 1.0)])
def test_a_foot_is_the_geom_farthest_out_and_signs_are_those_of_its_joints(
    sign, turn, up
):
    model = mujoco.MjModel.from_xml_string(FEET.format(sign=sign))
    pose = Pose.at(model, model.body("trunk").id, model.qpos0)
    (limb,) = find_limbs(pose, "here")
    assert (limb.foot, limb.swing, limb.lift, limb.hold) == ("far", "a", "b", ())
    assert (limb.turn, limb.up) == (turn, up)
    assert limb.hip == pytest.approx([0.1, 0.0])
    assert limb.toe == pytest.approx([0.3, 0.0, pose.bottom(model.geom("far").id)[2]])
