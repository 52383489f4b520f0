"""Which parts touch as groups swing and are raised, in a model of two legs."""

import mujoco
import numpy as np
import pytest

from models.adoption import groups as tried
from models.adoption.anatomy import Limb, Pose
from models.adoption.groups import _Trial

CLEARANCE = 1e-3  # [m] that parts keep from one another

LEG = """<body pos="0 {y} 0"><joint name="s{n}" axis="0 0 1"/>
  <joint name="l{n}" axis="0 1 0"/>
  <geom name="shin{n}" type="capsule" fromto="0.05 0 0 0.2 0 0" size="0.01"/>
  </body>"""
MODEL = """<mujoco><worldbody><geom type="plane" size="1 1 1" pos="0 0 -9"/>
  <body name="trunk" pos="1 2 3"><freejoint/>
  <geom name="hub" size="0.02"/>
  <body><joint/><geom size="0.001" pos="0 0 -1"/>{parts}</body>{legs}
  </body></worldbody></mujoco>"""
SECOND = 0.5  # [m] beside the first leg


ALONE = ({0: 1.0}, {1: 1.0})  # each leg a group


LEVELS = 4  # of angles, so that trials are few


@pytest.fixture(autouse=True)
def few(monkeypatch):
    monkeypatch.setattr(tried, "TRIED_ANGLES", LEVELS)


def trial(parts, groups=ALONE, lift=0.5, second=SECOND, reach=0.2):
    legs = LEG.format(n=0, y=0) + LEG.format(n=1, y=second)
    model = mujoco.MjModel.from_xml_string(MODEL.format(parts=parts, legs=legs))
    pose = Pose.at(model, model.body("trunk").id, model.qpos0)
    toe, hip = np.array([reach, 0.0, 0.0]), np.zeros(2)
    limbs = [
        Limb(f"s{n}", f"l{n}", (), f"shin{n}", (), hip, toe, 1, -1) for n in range(2)
    ]
    return _Trial(pose, limbs, groups, lift)


def ball(name, x, y, z, size=0.03):
    return f'<geom name="{name}" pos="{x} {y} {z}" size="{size}"/>'


def at(angle, length=0.2):
    return length * np.cos(angle), length * np.sin(angle)


@pytest.mark.parametrize(("reach", "kept"), [(0.2, CLEARANCE), (0.05, 5e-4)])
def test_parts_keep_a_millimetre_apart_or_a_hundredth_of_a_short_leg(reach, kept):
    """The same robot of a twentieth the size swings as far."""
    assert trial("", reach=reach)._pose.model.geom_margin[0] == pytest.approx(kept)


def test_where_nothing_is_near_nothing_touches():
    assert trial("").first_touching(0.4) is None


@pytest.mark.parametrize("leg", [0, 1])
def test_a_leg_touches_what_is_above_it_as_soon_as_it_is_raised(leg):
    roof = ball("roof", 0.2, leg * SECOND, 0.12)
    assert trial(roof).first_touching(0.4) == (0, ("roof", f"shin{leg}"))
    assert trial(roof, lift=0.1).first_touching(0.2) is None
    assert trial(roof, lift=-0.5).first_touching(0.2) is None


@pytest.mark.parametrize("leg", [0, 1])
@pytest.mark.parametrize(("side", "gain"), [(1, 1.0), (1, -0.8), (-1, 0.5)])
def test_a_leg_touches_what_is_beside_it_at_the_angle_that_takes_it_there(
    leg, side, gain
):
    angle, farthest, radius = 0.35, 0.5, 0.01
    x, y = at(side * angle)
    post = ball("post", x, y + leg * SECOND, 0.0, radius)
    groups = [{0: 1.0}, {1: 1.0}]
    groups[leg] = {leg: gain}
    found = trial(post, groups).first_touching(farthest)
    # the middle lines come as near as both radii and the clearance
    near = angle - np.arcsin((radius + 0.01 + CLEARANCE) / 0.2)
    level = int(np.ceil(near / (abs(gain) * farthest) * LEVELS))
    if level > LEVELS:
        assert found is None
    else:
        assert found == (level, ("post", f"shin{leg}"))


def test_parts_that_touch_where_the_robot_stands_may_touch_anywhere():
    x, y = at(0.05)
    assert trial(ball("near", x, y, 0.0)).first_touching(0.4) is None


@pytest.mark.parametrize("half", [0.013, 0.02, 0.03])
def test_parts_that_are_flush_stay_so_however_their_distance_is_rounded(half):
    """A leg turns on a round plate that just touches its shin from below."""
    plate = f'<geom name="plate" type="cylinder" size="0.1 {half}" pos="0 0 {{}}"/>'
    assert trial(plate.format(-half - 0.01)).first_touching(0.4) is None


@pytest.mark.parametrize(("apart", "level"), [(-1e-4, None), (5e-4, 1), (2e-3, 1)])
def test_parts_that_are_merely_near_where_it_stands_may_not_overlap(apart, level):
    beside = ball("near", 0.2, 0.01 + 0.03 + apart, 0.0)
    found = trial(beside).first_touching(0.4)
    assert found == (level and (level, ("near", "shin0")))


@pytest.mark.parametrize(("way", "level"), [(-1.0, 4), (1.0, 4)])
def test_legs_of_two_groups_meet_while_both_are_down(way, level):
    """Their tips at 0.2 m turn towards one another, from 0.2 m apart."""
    meet = np.arcsin((0.2 - 0.02 - CLEARANCE) / 0.4)
    assert 3 * 0.15 < meet < 4 * 0.15
    found = trial("", [{0: 1.0}, {1: way}], second=0.2).first_touching(0.6)
    assert found == (level, ("shin0", "shin1"))


def test_the_model_that_is_tried_is_a_copy():
    legs = LEG.format(n=0, y=0) + LEG.format(n=1, y=SECOND)
    model = mujoco.MjModel.from_xml_string(MODEL.format(parts="", legs=legs))
    pose = Pose.at(model, model.body("trunk").id, model.qpos0)
    before = pose.data.qpos.copy()
    limb = Limb("s0", "l0", (), "shin0", (), np.zeros(2), np.zeros(3), 1.0, -1.0)
    _Trial(pose, [limb], [{0: 1.0}, {}], 0.3).first_touching(0.4)
    assert pose.data.qpos.tolist() == before.tolist()
    assert not model.geom_margin.any()
