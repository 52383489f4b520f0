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
