"""Robots that cannot be used, and what is said about them."""

import pytest

from models.description.robot import FOLDER
from models.errors import ModelError
from models.library import load
from sim.preparation.setup import prepare

BODY, CARD, SCENE = (
    (FOLDER / name).read_text() for name in ("hexapod.xml", "hexapod.toml", "scene.xml")
)
POSE = 'qpos="0 0 0.06 1 0 0 0'
FOOT = 'name="foot_1" mass="0.009"'
FLOOR = 'name="floor"'
HIP = '<joint class="lift" name="lift_1"/>'
KNEE = f'{HIP}<joint name="knee_1" range="-0.2 0.2" limited="true" axis="0 1 0"/>'
THIRD = (HIP, KNEE, f"{POSE} 0 0", f"{POSE} 0 0 0")  # a joint more, and its angle
TORSO = '<body name="torso"'
TOE = '["foot_1"]'
SECOND = ("?", 'lift = "lift_2"')
PLANE = '<geom type="plane" size="1 1 1"'
PLATE = '<geom pos="0 0 0.018"'


@pytest.fixture
def robot(tmp_path, scenario):
    """Make the shipped hexapod with some of its text replaced, ready to walk."""

    def make(*edits):
        body, card, scene = BODY, CARD, SCENE
        for old, new in zip(edits[::2], edits[1::2], strict=True):
            assert any(old in text for text in (body, card, scene)), old
            body, card, scene = (t.replace(old, new) for t in (body, card, scene))
        (tmp_path / "scene.xml").write_text(scene)
        (tmp_path / "mine.xml").write_text(body)
        (tmp_path / "mine.toml").write_text(card)
        return prepare(scenario(robot=str(tmp_path / "mine.xml")))

    return make


PARTS = {
    "a joint is missing": (
        ['swing = "swing_1"', 'swing = "hip_yaw"', '["foot_2"]', '["toe"]'],
        "lacks: .*; joint 'hip_yaw', geom 'toe'; there are lift_1, .*swing_6$",
    ),
    "a joint is misspelt": (
        ['swing = "swing_1"', 'swing = "swing1"'],
        "did you mean 'swing_1'",
    ),
    "a joint is named twice": (
        ['swing = "swing_2"', 'swing = "swing_1"'],
        "joint 'swing_1' is named twice: .*; every joint belongs to one leg",
    ),
    "a foot is named twice": (
        ['["foot_2"]', '["foot_1"]'],
        "geom 'foot_1' is named twice",
    ),
    "a joint is another leg's": (
        ['lift = "lift_1"', "?", 'lift = "lift_2"', 'lift = "lift_1"', *SECOND],
        "leg 1: .*foot 'foot_1' does not move with joint 'lift_2'; it moves with 'sw",
    ),
    "a third joint is loose": (
        THIRD,
        r"with joint 'knee_1', which the card leaves loose; hold it: hold = \{ knee_1",
    ),
    "a third joint is held too far": (
        [*THIRD, TOE, f"{TOE}, hold = {{ knee_1 = 2 }}"],
        "'knee_1' is to be held at 2.0 rad, outside its range; hold it between -0.2",
    ),
    "a third joint has no servo": (
        [*THIRD, TOE, f"{TOE}, hold = {{ knee_1 = 0 }}"],
        r"joint 'knee_1' has no position servo: .*; give stiffness .*\[servo\]",
    ),
    "a leg slides": (
        ['<joint axis="0 -1 0"', '<joint type="slide" axis="0 -1 0"'],
        "leg 1: .*joint 'lift_1' is not a hinge",
    ),
    "a joint has damping = -5": (
        ['<joint axis="0 -1 0"', '<joint damping="-5" axis="0 -1 0"'],
        "leg 1: .*joint 'lift_1' has damping = -5; give it 0 to 1e6",
    ),
    "a joint has armature = -1e-4": (
        ['armature="0.0018"', 'armature="-1e-4"'],
        "leg 1: .*joint 'swing_1' has armature = -0.0001; give it 0 to 1e6",
    ),
    "a joint has frictionloss = -5": (
        ['<joint axis="0 -1 0"', '<joint frictionloss="-5" axis="0 -1 0"'],
        "leg 1: .*joint 'lift_1' has frictionloss = -5; give it 0 to 1e6",
    ),
    "a joint has stiffness = 1e30": (
        ['<joint axis="0 -1 0"', '<joint stiffness="1e30" axis="0 -1 0"'],
        "leg 1: .*joint 'lift_1' has stiffness = 1e.30; give it 0 to 1e6",
    ),
    "the body is fixed": (
        ['<freejoint name="root"/>', "", POSE, 'qpos="'],
        "0 free joints: .*; a walking robot has exactly one",
    ),
    "a free joint is on a child": (
        [TORSO, f"<body>{TORSO}", "</worldbody>\n  <act", "</body></worldbody><act"],
        "free joint can only be used on top level",
    ),
}  # fmt: skip
NUMBERS = {
    "a place": ([PLATE, '<geom pos="nan 0 0.018"'], "is not finite: .*, line 25;"),
    "a range": (['range="-0.1 0.6"', 'range="nan 0.6"'], "is not finite: .*, line 11;"),
    "an axis": (['axis="0 -1 0"', 'axis="0 nan 0"'], "is not finite: .*, line 11;"),
    "stiffness": (['kp="1000"', 'kp="inf"'], "is not finite: .*, line 8;"),
    "armature": (['"0.0018"', '"inf"'], "is not finite: .*, line 7;"),
    "mass": (
        ['mass="1"', 'mass="inf"'],
        "is not finite: .*, line 25; give one",
    ),
    "height": (
        ['pos="0 0 0.06"', 'pos="0 0 1e300"'],
        "body_invweight0 of body 'torso'",
    ),
}
POSTURES = {
    "upside down": (
        [POSE, 'qpos="0 0 0.3 0 1 0 0'],
        "starts upside down: the z axis of body 'torso' is 180 degrees off the vert",
    ),
    "tilted": (
        [POSE, 'qpos="0 0 0.06 0.99 0.14 0 0'],
        "starts tilted: .* 16.1 degrees off the vertical: .*; turn that body upright",
    ),
    "a leg is up": (
        [f"{POSE} 0 0", f"{POSE} 0 0.5"],
        "feet do not start on one floor: leg 1 ends 56.7 mm above leg",
    ),
    "feet are above the body": (
        ['pos="0.105 0 -0.052"', 'pos="0.105 0 0.2"'],
        "does not start on its feet: that of leg . is .* above the centre of mass",
    ),
    "swing and lift are exchanged": (
        ['swing = "swing_1", lift = "lift_1"', 'swing = "lift_1", lift = "swing_1"'],
        "leg 1: the axis of swing joint 'lift_1' is 90 degrees off the vertical",
    ),
    "raise has the wrong sign": (
        ['"lift_3", raise = 1', '"lift_3", raise = -1'],
        "leg 3: raise = -1 makes joint 'lift_3' lower its foot: .*; write raise = 1",
    ),
    "the lift joint does not lift": (
        ['<joint axis="0 -1 0"', '<joint axis="0 0 1"'],
        r"leg 1: joint 'lift_1' raises its foot by -?0.0 mm at lift_angle = 0.3",
    ),
    "the lift angle is out of range": (
        ["lift_angle = 0.3", "lift_angle = 0.7"],
        "lift_angle = 0.7 is beyond .*; give at most 0.6 rad, which raises .* 0.0684 m",
    ),
    "a leg stands at the end of its swing": (
        [f"{POSE} 0 0", f"{POSE} 0.45 0"],
        "group 1 stands at the end of its swing, which goes from -?0 to 0.45 rad",
    ),
}  # fmt: skip
GAITS = {
    "a group does not stand": (
        ["4 = -1, 5 = -1", "2 = -1, 3 = -1", "2 = 1, 3 = 1, 6", "4 = 1, 5 = 1, 6"],
        "cannot stand on groups 1: .*; their feet do not surround its weight",
    ),
    "the gait lifts one group only": (
        ['"12", "2", "12"]', '"12"]'],
        "steering needs two swings of standing legs, and the gait 12 1 12 has 1",
    ),
}  # fmt: skip
GROUNDS = {
    "a foot touches nothing": (
        [FOOT, f'{FOOT} contype="0" conaffinity="0"'],
        "foot 'foot_1' never touches anything: .*; its contype and conaffinity are 0",
    ),
    "a foot cannot touch the floor": (
        [FOOT, f'{FOOT} contype="4" conaffinity="4"'],
        "plane 'floor' cannot be touched by 'foot_1': .*; a floor is for all feet",
    ),
    "the floor is tilted": (
        [FLOOR, f'{FLOOR} euler="0 0.2 0"'],
        "plane 'floor' is tilted by 11.5 degrees: .*; a floor is horizontal",
    ),
    "feet stand on something else": (
        [TORSO, f'<geom type="box" name="slab" size="1 1 0.1" pos="0 0 -0.1"/>{TORSO}'],
        "foot 'foot_1' stands on geom 'slab', which is not the floor, geom 'floor'",
    ),
    "the body lies on the floor": (
        [PLATE, f'<geom name="belly" size="0.035" pos="0 0 -0.028"/>{PLATE}'],
        "does not stand: geom 'belly' lies on geom 'floor': .*; lift the body off it",
    ),
    "the weight is beside the feet": (
        [PLATE, f'<geom size="0.01" pos="0 0.3 0.1" mass="9"/>{PLATE}',
         "[group.1]", "[group.1]\ntwist = [0.04, 0, 0.5]",
         "[group.2]", "[group.2]\ntwist = [0.04, 0, -0.5]"],
        "does not stand: it tilts by .* degrees in 0.5 s: .*; put its feet around its",
    ),
    "there is no weight": (
        ["<worldbody>\n    <body", '<option gravity="0 0 1"/><worldbody><body'],
        "does not stand: no gravity pulls it down: .*; give <option> gravity=",
    ),
    "its parts push a foot up": (
        ['<joint class="swing" name="swing_2"/>',
         '<joint class="swing" name="swing_2"/>'
         '<geom name="bar" size="0.02" pos="-0.129 0.226 0" mass="0"/>',
         '<geom class="link"', '<geom class="link" contype="1"'],
        "touches nothing, while geom 'bar' and geom .* of it push against each",
    ),
    "servos are too weak": (
        ['kp="1000" kv="2.81424945589"', 'kp="1" kv="0.1"', "le = 0.3", "le = 0.05"],
        "does not stand: its legs give way by .* mm, and a lifted foot rises by 5.. mm",
    ),
    "servos are so weak that the body comes down": (  # by 10 mm
        [PLATE, f'<geom size="0.035" pos="0 0 -0.015"/>{PLATE}',
         'kp="1000" kv="2.81424945589"', 'kp="1" kv="0.1"', "le = 0.3", "le = 0.05"],
        "legs give way by .* mm, and a lifted foot rises by 5.. mm .* stiffen its",
    ),
}  # fmt: skip
ALL = PARTS | NUMBERS | POSTURES | GAITS | GROUNDS


@pytest.mark.parametrize(("edits", "message"), ALL.values(), ids=ALL)
def test_an_unusable_robot_is_refused_by_its_reason(robot, edits, message):
    with pytest.raises(ModelError, match=message) as refusal:
        robot(*edits)
    assert "mine.xml" in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    "edits",
    [
        [POSE, 'qpos="1 2 0.5 0.7 0 0 0.7'],  # elsewhere, in the air, turned
        [FLOOR, f'{FLOOR} pos="0 0 -0.5"'],
        [FLOOR, f'{FLOOR} contype="0" conaffinity="0"'],  # a picture of a floor
        [TORSO, f'{PLANE} name="wall" zaxis="1 0 0" pos="-2 0 0"/>{TORSO}'],
        [TORSO, f'{PLANE} name="cellar" pos="0 0 -1"/>{TORSO}'],
    ],
    ids=["start anywhere", "low floor", "painted floor", "wall", "cellar"],
)  # fmt: skip
def test_the_robot_is_put_on_the_floor_that_its_feet_can_touch(robot, edits):
    setup = robot(*edits)
    floor = setup.model.sensor("contact_foot_1").objid[0]
    height = setup.model.geom_pos[floor, 2]
    assert setup.model.geom_quat[floor, 0] == 1
    assert setup.model.key("start").qpos[:7] == pytest.approx(
        [0, 0, height + 0.06, 1, 0, 0, 0]
    )


def test_a_card_may_be_inside_the_mjcf(tmp_path, hexapod):
    (tmp_path / "scene.xml").write_text(SCENE)
    inside = f"<custom><text name='card' data='{CARD}'/></custom>"
    path = tmp_path / "one.xml"
    path.write_text(BODY.replace("<worldbody>", f"{inside}<worldbody>"))
    robot = load(str(path))
    assert (robot.card, robot.card_text) == (hexapod.card, CARD)
    path.with_suffix(".toml").write_text(CARD)
    with pytest.raises(ModelError, match="two robot cards: .*one.toml, and the custom"):
        load(str(path))


def test_a_robot_without_a_card_is_told_where_one_may_be(tmp_path):
    (tmp_path / "scene.xml").write_text(SCENE)
    path = tmp_path / "bare.xml"
    path.write_text(BODY.replace('model="hexapod"', 'model="mine"'))
    with pytest.raises(ModelError, match="bare.toml is missing; draft one: strat"):
        load(str(path))
