"""A joint with backlash turns about its own axis, however its file is written."""

import mujoco
import numpy as np
import pytest

from sim.world.imperfections import add_loose

LATER = 'axis="0.6 -0.8 0" stiffness="0.3" damping="0.02" frictionloss="0.1"'
LEG = """
<body name="leg" pos="0.1 0 0" euler="{third} 0 0">
  <joint name="before" axis="1 0 0"/>
  {swing}
  <joint name="lift" {later} range="-{third} {third}" springref="{third}"
    springyield="{third}"/>
  <joint name="slide" type="slide" axis="0 0 1" range="-0.02 0.02" springref="0.01"/>
  <geom name="foot" size="0.01" pos="0.1 0 0.05"/>
</body>"""
PLAIN = '<joint name="swing" axis="0 0 1" pos="0.01 0.02 0"/>'
FRAMED = f'<frame euler="{{third}} 0 0" pos="0 0.01 0">{PLAIN}</frame>'
ANGLES = {"degree": 30.0, "radian": np.pi / 6}
ATTACHED = """<mujoco><compiler angle="{outer}"/>
<asset><model name="part" file="part.xml"/></asset>
<worldbody><attach model="part" body="leg" prefix="a_"/></worldbody>
<actuator><position name="servo" joint="a_lift" kp="2"/></actuator></mujoco>"""
INNER = '<mujoco><compiler angle="{inner}"/><worldbody>{leg}</worldbody></mujoco>'


@pytest.mark.parametrize("swing", [PLAIN, FRAMED], ids=["plain", "in a frame"])
@pytest.mark.parametrize("inner", ANGLES)
@pytest.mark.parametrize("outer", ANGLES)
def test_backlash_turns_about_its_own_joint_of_several_in_a_body(
    swing, inner, outer, tmp_path
):
    leg = LEG.replace("{swing}", swing).format(third=ANGLES[inner], later=LATER)
    (tmp_path / "part.xml").write_text(INNER.format(inner=inner, leg=leg))
    (whole := tmp_path / "whole.xml").write_text(ATTACHED.format(outer=outer))
    spec = mujoco.MjSpec.from_file(str(whole))
    rigid = spec.copy().compile()
    add_loose(spec, "a_swing", "loose_", 0.02, armature=1e-6)
    loose = spec.compile()
    assert [loose.joint(i).name for i in range(loose.njnt)] == [
        *("a_before", "a_swing", "loose_a_swing", "a_lift", "a_slide")
    ]
    assert loose.joint("loose_a_swing").range == pytest.approx([-0.01, 0.01])
    for name in ("a_before", "a_swing", "a_lift", "a_slide"):
        for kept in ("range", "stiffness", "damping", "frictionloss", "axis", "pos"):
            after, before = (getattr(m.joint(name), kept) for m in (loose, rigid))
            assert after == pytest.approx(before, abs=1e-12), (name, kept)
        after, before = (m.qpos_spring[m.joint(name).qposadr] for m in (loose, rigid))
        assert after == pytest.approx(before)
    after, before = (m.jnt_springyield[m.joint("a_lift").id] for m in (loose, rigid))
    assert after == pytest.approx(before)
    assert loose.actuator("servo").trnid[0] == loose.joint("a_lift").id
    data, other = mujoco.MjData(loose), mujoco.MjData(rigid)
    angles = {"a_before": 0.3, "a_swing": 0.2, "a_lift": -0.8, "a_slide": 0.01}
    for name, angle in angles.items():
        data.joint(name).qpos = other.joint(name).qpos = angle
    data.joint("loose_a_swing").qpos, other.joint("a_swing").qpos = 0.1, 0.3
    mujoco.mj_kinematics(loose, data)
    mujoco.mj_kinematics(rigid, other)
    assert data.joint("loose_a_swing").xaxis == pytest.approx(
        data.joint("a_swing").xaxis
    )
    assert data.geom("a_foot").xpos == pytest.approx(other.geom("a_foot").xpos)
