"""Drafted crawls: four legs row, and every one can be set back while three stand."""

import re

import mujoco
import numpy as np
import pytest

from models.adoption import crawl
from models.adoption.anatomy import Pose, find_limbs
from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.contact.loads import StaticStability
from models.errors import ModelError
from models.library import load
from models.motion.robot_equations import equations, mobility_of
from planner.planning.algorithm import plan
from planner.planning.paths import line
from scripts.adoptees import Adoptee, parallel, radial

FOUR = Adoptee("four", radial(4), drive="motor")
OTHERS = (
    FOUR,
    Adoptee("dog", parallel(4, 0.16, 0.05), joints=2),
    Adoptee("plus", [(0.1, 0, 0), (0, 0.1, 1.57), (-0.1, 0, 3.14), (0, -0.1, -1.57)]),
)


def adopted(adoptee, folder):
    path = adoptee.write(folder)
    found = draft_card(source_of(str(path)))
    path.with_suffix(".toml").write_text(found.card)
    return load(str(path)), found


@pytest.fixture(scope="module", params=OTHERS, ids=lambda adoptee: adoptee.name)
def robot(request, tmp_path_factory):
    return adopted(request.param, tmp_path_factory.mktemp("crawl"))[0]


def test_two_patterns_and_their_bracket_go_everywhere(robot):
    described = equations(robot)
    assert described.elements[:2] == ("g1234_forward", "g1234_turn")
    assert not mobility_of(robot, described).lacking
    forward, _, turned = described.twists["g1234_forward"]
    assert forward > abs(turned) * np.linalg.norm(robot.model.stat.center[:2])
    assert described.twists["g1234_turn"][2] > 0


def test_no_foot_that_stands_bears_too_little_while_another_is_set_back(robot):
    described = equations(robot)
    goal = described.configurations(line((0, 0, 0), (0.03, 0.0, 0.0)))
    planned = plan(described, goal, 1)
    angles, system = np.zeros(4), described.system
    stability = StaticStability(robot)
    lifted = 0
    for flow in planned.flows:
        if flow.stratum != "1234":
            lifted += 1
            (load_,) = stability.least_loads([flow.stratum], angles.reshape(4, 1))
            assert load_.min() >= robot.card.least_load - 1e-9
        direction = np.array(described.swings[flow.field])
        angles = angles + direction * flow.duration
    assert system.bottom == "1234"
    assert lifted >= 4
    assert angles == pytest.approx(np.zeros(4), abs=1e-9)


UNDER = """<mujoco><worldbody><body name="trunk" pos="0 0 0.3"><freejoint/>
  <geom type="box" size="0.1 0.1 0.02" contype="0" conaffinity="0"/>{}
</body></worldbody></mujoco>"""
HOOK = """<body pos="{1} {2} 0"><joint name="yaw{0}" axis="0 0 1"/>
  <geom type="sphere" size="0.01" contype="0" conaffinity="0"/>
  <body pos="0.05 0 0"><joint name="pitch{0}" axis="0 1 0"/>
    <geom name="toe{0}" type="sphere" size="0.01" pos="-0.05 0 -0.08"/></body></body>"""


def test_a_posture_is_taken_only_if_legs_can_row_to_both_sides(tmp_path, monkeypatch):
    """Walking the other way uses the same strokes in the opposite direction."""
    tried = []

    def moves(body, draft, ends, ranges):
        tried.append(ends)
        return True

    monkeypatch.setattr(crawl, "_moves", moves)
    adopted(FOUR, tmp_path)
    assert len(tried) == 4  # ahead, back, and around either way
    assert all(any((end == -other).all() for other in tried) for end in tried)


def test_feet_below_the_joints_that_swing_them_push_nothing(tmp_path):
    places = [(0.1, 0.1), (0.1, -0.1), (-0.1, 0.1), (-0.1, -0.1)]
    path = tmp_path / "under.xml"
    hooks = "".join(HOOK.format(k, *place) for k, place in enumerate(places))
    path.write_text(UNDER.format(hooks))
    with pytest.raises(
        ModelError, match="foot 'toe.' is right below the joint that sw"
    ):
        draft_card(source_of(str(path)))


def test_a_hinge_without_an_end_worth_the_name_is_as_one_that_turns_far(tmp_path):
    swings = {}
    for end in ("-100", "-1e308"):
        path = FOUR.write(tmp_path)
        whole = path.read_text()
        text = re.sub(r'(name="yaw1"[^>]*range=")[^ "]*', rf"\g<1>{end}", whole)
        assert text != whole
        path.write_text(text)
        swings[end] = draft_card(source_of(str(path))).card
    assert swings["-1e308"] == swings["-100"]


def test_weight_is_off_the_lines_between_opposite_feet(tmp_path):
    """As drawn, the weight is where they cross, and no leg could be lifted."""
    robot, found = adopted(FOUR, tmp_path)
    assert np.abs(found.gait.turns).max() > 0.05
    singles = [name for name in robot.card.gait if name != "1234"]
    shares = StaticStability(robot).least_loads(singles, [np.zeros(1)] * 4)
    assert np.abs(shares).min() > 0.01


def test_legs_that_are_not_turned_stand_where_their_toes_are(tmp_path):
    model = mujoco.MjModel.from_xml_path(str(FOUR.write(tmp_path)))
    root = int(model.jnt_bodyid[0])
    pose = Pose.at(model, root, model.qpos0)
    limbs = find_limbs(pose, "four")
    feet, weight = crawl._Body.of(pose, limbs).placed(np.zeros(len(limbs)))
    assert feet == pytest.approx(np.array([limb.toe[:2] for limb in limbs]))
    assert weight == pytest.approx(pose.center_of_mass[:2])
