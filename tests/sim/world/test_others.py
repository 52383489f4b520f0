"""What moves a robot beside its servos is left out; what moves other parts stays."""

import pytest

from sim.preparation.setup import prepare
from sim.world.changes import changes
from tests.sim.world.test_changes import START

THRUST = {
    "adhesion": "".join(
        f'<adhesion name="stick_{leg}" body="leg_{leg}" ctrlrange="1 9" gain="5"/>'
        for leg in range(1, 7)
    ),
    "a thruster": '<motor name="thruster" site="rear" gear="1 0 0 0 0 0"/>',
    "a pull": '<general name="pull" joint="root" biastype="affine" biasprm="3 0 0"/>',
}


@pytest.mark.parametrize("kind", THRUST)
def test_what_pushes_or_sticks_the_body_is_left_out_and_told(kind, edited, scenario):
    """Predictions know nothing of it; whether a foot touches makes no difference."""
    robot = edited(
        "</actuator>", f"{THRUST[kind]}</actuator>",
        "<freejoint", '<site name="rear"/><freejoint',
    )  # fmt: skip
    assert robot.model.nu == 12 + (6 if kind == "adhesion" else 1)
    assert prepare(scenario(), robot).model.nu == 12
    (told,) = changes(robot, scenario())
    name = robot.model.actuator(12).name
    assert f"actuators '{name}'" in told
    assert "or move the body; they are left out" in told


def test_what_moves_other_parts_alone_stays(edited, scenario):
    """On a tail, by its joint or by a tendon."""
    tail = """<body name="tail" pos="-0.1 0 0.05"><joint name="wag" damping="1"/>
      <geom name="fur" size="0.01" mass="0.01" contype="0" conaffinity="0"/></body>"""
    rope = '<tendon><fixed name="rope"><joint joint="wag" coef="1"/></fixed></tendon>'
    wags = '<motor name="a" joint="wag"/><motor name="b" tendon="rope"/></actuator>'
    robot = edited(
        "<freejoint", f"{tail}<freejoint", "</actuator>", wags,
        "<sensor>", f"{rope}<sensor>", START, START.replace('0"', '0 0"'),
    )  # fmt: skip
    assert prepare(scenario(), robot).model.nu == 14
    assert not list(changes(robot, scenario()))


BETWEEN_LEGS = {
    "a weld to the body": '<weld name="bar" body1="leg_1" body2="torso"/>',
    "a weld": '<weld name="bar" body1="leg_1" body2="leg_2"/>',
    "a hinge": '<connect name="bar" body1="leg_3" body2="leg_6" anchor="0 0 0"/>',
}


@pytest.mark.parametrize("kind", BETWEEN_LEGS)
def test_what_ties_legs_together_no_longer_holds_and_is_told(kind, edited, scenario):
    """And what holds a leg where it turns anyway stays."""
    own = '<connect body1="leg_4" body2="torso" anchor="0 0 0"/>'
    ties = f"<equality>{BETWEEN_LEGS[kind]}{own}</equality><sensor>"
    robot = edited("<sensor>", ties)
    assert prepare(scenario(), robot).model.eq_active0.tolist() == [0, 1]
    (told,) = changes(robot, scenario())
    assert "equations 'bar' couple leg joints" in told


SLIDES = "".join(
    f'<joint name="{axis}" type="slide" axis="{axis}" damping="0.1"/>'
    for axis in ("1 0 0", "0 1 0")
)
ROUNDED = SLIDES.replace('axis="0 1 0"', 'axis="0 1 2e-4"')  # as drawings have it
TURNS = '<joint name="rod" axis="0 0 1" damping="0.1"/>'


@pytest.mark.parametrize(
    ("joints", "more", "stays"),
    [(SLIDES, "0 0", True), (ROUNDED, "0 0", True), (TURNS, "0", False)],
)
def test_what_closes_a_linkage_within_a_leg_stays_where_it_can_follow(
    edited, scenario, joints, more, stays
):
    """A part on joints that nothing drives, tied to the axis of a lift; one tears."""
    rod = f"""<body name="rod">{joints}
      <geom size="0.001" mass="0.001" contype="0" conaffinity="0"/></body>"""
    tie = '<connect name="bar" body1="leg_1" body2="rod" anchor="0 0.01 0"/>'
    robot = edited(
        "<freejoint", f"{rod}<freejoint", START, START.replace('0"', f'0 {more}"'),
        "<sensor>", f"<equality>{tie}</equality><sensor>",
    )  # fmt: skip
    assert prepare(scenario(), robot).model.eq_active0.tolist() == [stays]
    told = [line for line in changes(robot, scenario()) if "equations 'bar'" in line]
    assert len(told) == (not stays)
    assert len(list(changes(robot, scenario()))) == len(told)


@pytest.mark.parametrize(
    "held", ["", 'damping="0.1"', 'stiffness="1"', 'frictionloss="0.1"']
)
def test_a_part_that_nothing_holds_is_told(held, edited, scenario):
    part = f"""<body name="box"><joint name="rail" type="slide" {held}/>
      <geom size="0.01" mass="0.1" contype="0" conaffinity="0"/></body>"""
    key = START.replace('0"', '0 0"')
    robot = edited("<freejoint", f"{part}<freejoint", START, key)
    told = list(changes(robot, scenario()))
    assert len(told) == (held == "")
    assert all("joints 'rail' are held by no servo, spring" in line for line in told)
