"""Drafts of cards: legs, joints, groups, pivots and postures found in foreign files."""

import re
from functools import cache

import mujoco
import numpy as np
import pytest

from models.adoption.anatomy import servo_for
from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.contact.kinematics import Kinematics
from models.description.card_file import parse_card
from models.errors import ModelError, UnknownRobotError
from models.library import load
from models.motion.robot_equations import equations
from scripts.adoptees import ADOPTEES, Adoptee, parallel, radial
from tests import owners

BOX = ADOPTEES[-1]
SOME = [a for a in ADOPTEES if a.name in ("spider", "crab", "box")]
DOG = """<mujoco>
  <worldbody><body name="trunk" pos="0 0 0.3"><freejoint/>
    <geom type="box" size="0.2 0.1 0.03"/>{}
  </body></worldbody></mujoco>"""
PAW = """
    <body name="roll{0}" pos="{1} {2} 0"><joint name="roll{0}" axis="1 0 0"/>
      <geom type="sphere" size="0.01"/>
      <body name="pitch{0}"><joint name="pitch{0}" axis="0 1 0"/>
        <geom name="paw{0}" type="capsule" size="0.01" fromto="0 0 0 0 0 -0.2"/>
      </body></body>"""


def adopted(adoptee, folder):
    """The robot with its drafted card beside it, and the draft."""
    source = source_of(str(adoptee.write(folder)))
    found = draft_card(source)
    if source.text is not None:
        source.path.write_text(source.text)
    source.path.with_suffix(".toml").write_text(found.card)
    return load(str(source.path)), found


@pytest.fixture(scope="module")
def drafted(tmp_path_factory):
    """Robots with drafted cards, each drafted once."""
    return cache(lambda adoptee: adopted(adoptee, tmp_path_factory.mktemp("drafted")))


@pytest.mark.parametrize("adoptee", SOME, ids=lambda adoptee: adoptee.name)
def test_joints_and_feet_are_found_by_what_they_do(adoptee, drafted):
    robot, _ = drafted(adoptee)
    assert len(robot.legs) == len(adoptee.hips)
    for leg in robot.card.legs.values():
        number = leg.swing.removeprefix("yaw")
        assert leg.lift == f"pitch{number}"
        assert list(leg.hold) == [f"knee{number}"] * (adoptee.joints - 2)
        assert leg.raise_sign == -1  # a positive pitch lowers the foot
        foot = robot.model.geom(leg.foot[0])
        # beside nothing but ghosts, a toe is the only sphere of its leg
        assert foot.size[0] == pytest.approx(0.009 * adoptee.size)


@pytest.mark.parametrize("adoptee", SOME, ids=lambda adoptee: adoptee.name)
def test_legs_of_a_group_meet_at_the_pivot_that_the_body_turns_about(adoptee, drafted):
    robot, found = drafted(adoptee)
    described = equations(robot)
    stance = Kinematics(robot).standing
    for i, (name, place) in enumerate(zip("12", found.gait.pivots, strict=True)):
        forward, left, yaw = described.twists[f"g{name}_{name}"]
        pivot = np.array([-left, forward]) / yaw
        assert pivot == pytest.approx(place, abs=1e-4)
        on = robot.planted(name)
        # at rest no foot slips: it moves against the body as the floor does
        body = yaw * np.stack([-stance.feet[:, 1], stance.feet[:, 0]], axis=1)
        slip = stance.rates + body + (forward, left)
        assert np.abs(slip[on]).max() < 1e-4
        assert set(np.flatnonzero(robot.group_of_leg == i)) == set(np.flatnonzero(on))


@pytest.mark.parametrize("write", [owners.handmade, owners.motors])
def test_legs_of_a_group_swing_in_ratios_of_small_whole_numbers(write, tmp_path):
    found = draft_card(source_of(str(write(tmp_path)))).gait
    gains = np.abs([[*swings.values()] for swings in found.swings])
    assert np.unique(gains).size == 2
    parts = {"handmade": 2, "motors": 3}[write.__name__]  # 0.48 and 0.61 elsewhere
    assert parts * gains == pytest.approx(np.round(parts * gains), abs=1e-8)
    assert gains.min() > 0.1


def test_a_trunk_may_be_fixed_to_an_empty_root(tmp_path):
    text = (path := ADOPTEES[0].write(tmp_path)).read_text()
    card, free = draft_card(source_of(str(path))).card, "      <freejoint/>"
    text = text.replace(free, f'{free}<body name="own">').replace('"trunk"', '"base"')
    path.write_text("</body></body>".join(text.rsplit("</body>", 1)))
    assert draft_card(source_of(str(path))).card == card


def test_straight_knees_are_bent_to_stand(drafted):
    robot, found = drafted(ADOPTEES[0])
    assert "knees were bent" in found.guesses[0]
    height = Kinematics(robot).standing.height
    assert np.ptp(height) < 1e-6
    assert robot.card.start["knee1"] != 0.0


def test_feet_far_below_their_lift_joints_are_spread(tmp_path):
    path = owners.turntable(tmp_path)
    start = parse_card(draft_card(source_of(str(path))).card, "draft").start
    raised = np.array([start[f"raise_{leg}"] for leg in range(1, 7)])
    assert raised == pytest.approx(np.deg2rad(12))
    # of the foot's end, 30 mm beside and 90 mm below, and its round of 14 mm
    side, below = np.hypot(0.03, 0.09) * np.array(
        [
            np.cos(np.arctan2(0.09, 0.03) - raised[0]),
            np.sin(np.arctan2(0.09, 0.03) - raised[0]),
        ]
    )
    assert 1.9 < (below + 0.014) / side <= 2


def test_forward_is_forward_for_a_positive_angle(drafted):
    robot, _ = drafted(ADOPTEES[0])
    assert equations(robot).twists["g1_1"][0] > 0
    assert equations(robot).twists["g2_2"][0] > 0


def refusal(path):
    with pytest.raises(ModelError) as refused:
        draft_card(source_of(str(path)))
    return str(refused.value)


def test_legs_without_a_vertical_axis_are_refused_for_that(tmp_path):
    path = tmp_path / "dog.xml"
    places = [(0.2, 0.1), (0.2, -0.1), (-0.2, 0.1), (-0.2, -0.1)]
    paws = "".join(PAW.format(k, *place) for k, place in enumerate(places))
    path.write_text(DOG.format(paws))
    assert "cannot swing" in refusal(path)
    assert "90 degrees off" in refusal(path)


def test_legs_that_can_neither_stand_in_groups_nor_row_are_refused_for_both(tmp_path):
    said = refusal(Adoptee("three", radial(3)).write(tmp_path))
    assert "no two groups of its 3 legs can stand alone in turn, and its 3 legs" in said
    path = Adoptee("stiff", radial(4)).write(tmp_path)
    path.write_text(path.read_text().replace("-1.2 1.2", "-0.05 0.05"))
    said = refusal(path)
    assert "no two groups of its 4 legs can stand alone in turn, and its legs" in said
    assert "some foot bears less than 6% of the weight while another one" in said


def test_legs_that_cannot_meet_are_refused_for_that(tmp_path):
    said = refusal(Adoptee("long", parallel(8, 0.36)).write(tmp_path))
    assert "cannot be turned so that they meet at pivots" in said


@pytest.mark.parametrize(("folder", "quote"), [("bot", '"'), ("clone_of_bot", "'")])
def test_urdf_finds_meshes_of_its_package_and_can_be_moved(tmp_path, folder, quote):
    package = tmp_path / folder
    for folder in ("urdf", "meshes"):
        (package / folder).mkdir(parents=True)
    corners = ("0 0 0", "0.01 0 0", "0 0.01 0", "0 0 0.01")
    (package / "meshes" / "hull.obj").write_text(
        "\n".join(
            [
                *(f"v {c}" for c in corners),
                "f 1 3 2",
                "f 1 2 4",
                "f 1 4 3",
                "f 2 3 4",
                "",
            ]
        )
    )
    path = ADOPTEES[-1].write(package / "urdf")
    file = f"{quote}package://bot/meshes/hull.obj{quote}"
    hull = f"<geometry><mesh filename={file}/></geometry>"
    text = path.read_text().replace(
        "</link>", f"<collision>{hull}</collision></link>", 1
    )
    path.write_text(text)
    with pytest.raises(ModelError, match="outside its own folder: .*box.urdf; .*hull"):
        source_of(str(path))
    source = source_of(str(path), allow_external=True)
    assert [file.name for file in path.parent.iterdir()] == ["box.urdf"]
    assert "../meshes/hull.obj" in source.text
    assert str(tmp_path) not in source.text
    assert len(draft_card(source).limbs) == 6


def test_a_urdf_without_its_meshes_is_drawn_from_frame_to_frame(tmp_path):
    source = source_of(str(owners.meshes(tmp_path)))
    (note,) = source.notes
    assert "package://robot_description/meshes/base.stl" in note  # as it was written
    assert "and 2 more" in note
    source.path.write_text(source.text)
    draft = draft_card(source)
    source.path.with_suffix(".toml").write_text(draft.card)
    assert draft.guesses[0] == note
    # feet at twice the centre of mass of a tibia, (0.02, 0, -0.09) from its joint
    reach = np.linalg.norm(draft.limbs[0].toe[:2] - draft.limbs[0].hip)
    assert reach == pytest.approx(0.04 + 0.06 + 0.02, abs=0.002)
    assert len(load(str(source.path)).legs) == 6


def test_a_link_without_mesh_joint_and_mass_is_refused_by_name(tmp_path):
    path = owners.meshes(tmp_path)
    text = path.read_text().replace('<origin xyz="0.01 0 -0.045"/>', "")
    path.write_text(text)
    with pytest.raises(ModelError, match="no end of link 'tibia_1' is known"):
        source_of(str(path))


def test_folder_is_that_of_its_robot_and_not_of_its_scene(tmp_path):
    ADOPTEES[0].write(tmp_path)
    (tmp_path / "scene.xml").write_text("<mujoco><include file='spider.xml'/></mujoco>")
    assert source_of(str(tmp_path)).path == tmp_path / "spider.xml"
    (tmp_path / "spider.xml").unlink()
    with pytest.raises(
        UnknownRobotError, match="no MJCF file with a free joint, of 1 in all"
    ):
        source_of(str(tmp_path))


def test_a_drafted_servo_damps_critically(drafted):
    """What it moves is its leg, and its rotor where the model lacks that."""
    robot, _ = drafted(ADOPTEES[0])
    servo, model = servo_for(robot), robot.model
    data = mujoco.MjData(model)
    data.qpos = robot.start_qpos
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    joints = [model.joint(name).dofadr[0] for name in robot.card.joints]
    inertia = np.median(np.diag(full)[joints]) + servo.armature
    assert servo.damping**2 == pytest.approx(4 * servo.stiffness * inertia, rel=1e-6)


def written(adoptee, folder, old, new, count=0):
    """The file of an adoptee with some of its text replaced."""
    path = adoptee.write(folder)
    text, found = re.subn(old, new, path.read_text(), count=count)
    assert found
    path.write_text(text)
    return path


def test_swing_joints_drawn_at_an_end_of_their_ranges_start_in_the_middle(tmp_path):
    own = draft_card(source_of(str(ADOPTEES[0].write(tmp_path))))
    # the same robot, drawn with its hips at -1.2 rad of their -1.2 to 1.2
    path = written(ADOPTEES[0], tmp_path, r'name="yaw\d"', r'\g<0> ref="-1.2"')

    def turned(quat):
        w, _, _, z = map(float, quat[2].split())
        half = np.arctan2(z, w) - 0.6
        return f'{quat[1]}{np.cos(half)} 0 0 {np.sin(half)}"'

    hips = r'(<body name="hip\d" pos="[^"]*"\s+quat=")([^"]*)"'
    path.write_text(re.sub(hips, turned, path.read_text()))
    draft = draft_card(source_of(str(path)))
    assert "swing joints, 'yaw1' and 5 more, are drawn at or beyond" in draft.guesses[0]
    start, wanted = (parse_card(d.card, "draft").start for d in (draft, own))
    # hips of the file have nine digits, and bisections thirty steps
    assert start == pytest.approx(wanted, abs=1e-6)


def test_feet_that_are_drawn_unevenly_are_put_on_one_floor(tmp_path):
    pitches = r"<origin xyz=\"0.03 0 0\"/>"  # of leg 1
    path = written(BOX, tmp_path, pitches, '<origin xyz="0.03 0 0.002"/>', count=1)
    source = source_of(str(path))
    card = draft_card(source)
    assert not any("knees were bent" in guess for guess in card.guesses)
    source.path.write_text(source.text)
    source.path.with_suffix(".toml").write_text(card.card)
    heights = Kinematics(load(str(source.path))).standing.height
    assert np.ptp(heights) < 1e-6  # of 2 mm; Newton's steps leave 1e-12


def test_a_urdf_that_is_only_drawn_touches_with_what_is_drawn(tmp_path):
    solid = source_of(str(BOX.write(tmp_path)))
    shown = source_of(str(written(BOX, tmp_path, "collision>", "visual>")))
    assert shown.text == solid.text
    assert not solid.notes
    assert "no link has a <collision>" in shown.notes[0]
    assert draft_card(shown).card == draft_card(solid).card


def test_a_urdf_without_shapes_has_no_legs(tmp_path):
    path = written(BOX, tmp_path, r"(?s)<collision>.*?</collision>", "")
    assert "no legs were found" in refusal(path)


def test_a_link_without_mass_is_refused_with_what_to_write(tmp_path):
    inertial = r"(?s)(<link name=\"hip3\">\s*)<inertial>.*?</inertial>"
    message = refusal(written(BOX, tmp_path, inertial, r"\1"))
    assert "'hip3'" in message
    assert message.endswith("give it shapes that have mass (in URDF: <collision>)")
    assert "fused" not in message
