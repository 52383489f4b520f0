"""Swing ranges of drafts: as far as legs go without touching, and what ends them."""

import re
import shutil

import mujoco
import numpy as np
import pytest

from models.adoption.anatomy import Pose, find_limbs
from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.errors import ModelError
from models.library import load
from scripts.adoptees import ADOPTEES
from tests import owners

FARTHEST = 1e3  # [rad] that a hinge is taken to turn, whatever its range says


def drafted(path):
    draft = draft_card(source_of(str(path)))
    path.with_suffix(".toml").write_text(draft.card)
    return load(str(path)), draft.guesses[-2:]


def touching(robot, swing, lift):
    """Pairs of the robot's geoms that overlap at angles of its groups."""
    model, data = robot.model, mujoco.MjData(robot.model)
    data.qpos[:] = robot.start_qpos
    for joint, angle in robot.leg_angles(np.array(swing), np.array(lift)).items():
        data.joint(joint).qpos[0] += angle
    mujoco.mj_forward(model, data)
    pairs = [c.geom for c in data.contact[: data.ncon] if c.dist < 0]
    return {tuple(pair) for pair in pairs if model.geom_bodyid[pair].all()}


def test_legs_swing_until_they_would_touch_and_the_draft_names_what_touches(tmp_path):
    robot, said = drafted(owners.turntable(tmp_path))
    (low, high) = robot.swing_range["1"]
    assert 0.3 < high == -low < 0.7  # the joints would let them go to 0.9
    assert any(
        "beyond which 'shin_3' and 'shin_5' would touch" in line for line in said
    )
    angle = robot.card.lift_angle
    always = touching(robot, (0, 0), (0, 0))
    ends = np.linspace(low, high, 9)
    for one in ends:
        for other in ends:
            for lift in ((0, 0), (angle, 0), (0, angle)):
                assert touching(robot, (one, other), lift) <= always
    farther = np.linspace(-1.4, 1.4, 7) * high
    assert any(
        touching(robot, (a, b), (0, 0)) - always for a in farther for b in farther
    )


def test_ranges_beyond_a_quarter_turn_do_not_change_how_far_legs_swing(tmp_path):
    """As of joints without a range, or with limits in degrees by mistake."""
    path = owners.turntable(tmp_path)
    text, found = path.read_text(), set()
    for most in (130, 3000):
        wide = f'range="-{most} {most}"'
        path.write_text(text.replace('range="-80 80"', wide))
        assert path.read_text().count(wide) == 6 + 12
        found.add(draft_card(source_of(str(path))).card)
    assert len(found) == 1


def test_where_nothing_touches_the_joints_end_the_swing(tmp_path):
    robot, said = drafted(owners.handmade(tmp_path))
    assert robot.card.groups["1"].swing is None
    limit = "0.47 rad either way, where 'h1' is the first joint to reach an end of "
    assert any(limit in line for line in said)


def test_legs_that_touch_at_once_are_refused_with_their_parts(tmp_path):
    path = owners.turntable(tmp_path)
    path.write_text(path.read_text().replace('size=".014"', 'size=".042"'))
    with pytest.raises(ModelError, match="'shin_.' and 'shin_.' touch at once"):
        draft_card(source_of(str(path)))


def test_a_hinge_without_a_range_may_go_a_quarter_turn_either_way():
    text = """<mujoco><worldbody><body><joint name="free"/><geom size=".1"/>
    <body><joint name="held" range="-10 90000" limited="true"/><geom size=".1"/></body>
    </body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    pose = Pose(model, mujoco.MjData(model), 1)
    assert pose.span("free") == pytest.approx((-np.pi / 2, np.pi / 2))
    low, high = pose.span("held")
    assert low == pytest.approx(np.radians(-10))
    assert high == pytest.approx(FARTHEST)


@pytest.mark.parametrize("joint", ['type="slide" name="knee"', 'type="hinge"', ""])
def test_every_joint_of_a_leg_must_be_a_hinge_with_a_name(joint):
    text = f"""<mujoco><worldbody><body name="torso"><freejoint/><geom size=".1"/>
    <body pos=".2 0 0"><joint name="hip" axis="0 0 1"/><geom size=".02"/>
    <body pos=".2 0 0"><joint {joint} axis="0 1 0"/><geom name="toe" size=".02"/>
    </body></body></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    pose = Pose.at(model, 1, model.qpos0)
    with pytest.raises(ModelError, match="hinge") as caught:
        find_limbs(pose, "here")
    assert "toe" in str(caught.value)


def test_servos_end_the_swing_as_joints_do(tmp_path, hexapod):
    """Where their range is the narrower one."""
    shutil.copy(hexapod.path.with_name("scene.xml"), tmp_path)
    servo = '<position class="swing" name="swing_2" joint="swing_2"'
    text = hexapod.path.read_text().replace(servo, f'{servo} ctrlrange="-0.2 0.2"')
    (tmp_path / "mine.xml").write_text(text)
    robot, _ = drafted(tmp_path / "mine.xml")
    assert min(high - low for low, high in robot.swing_range.values()) <= 0.4001


@pytest.mark.parametrize(
    ("limit", "span"), [('upper="0.9"', (0, 0.9)), ('lower="-0.9"', (-0.9, 0))]
)
def test_an_end_of_a_joint_s_limits_that_is_left_out_is_zero(tmp_path, limit, span):
    """The compiler would take such a joint for one that turns freely."""
    path = next(one for one in ADOPTEES if one.name == "box").write(tmp_path)
    text, count = re.subn(
        r'lower="[^"]*" upper="[^"]*"', limit, path.read_text(), count=1
    )
    path.write_text(text)
    name = re.search('<joint name="([^"]*)"', text)[1]
    joint = source_of(str(path)).spec().compile().joint(name)
    assert (count, joint.limited[0]) == (1, True)
    assert joint.range == pytest.approx(span)
