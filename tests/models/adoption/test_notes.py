"""What a URDF does not say, or says and is not kept, is told whoever adopts it."""

import pytest

from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.errors import ModelError
from scripts.adoptees import ADOPTEES
from tests.models.adoption.test_draft import BOX, written


def test_links_that_weigh_as_much_as_water_are_named(tmp_path):
    """In ROS such a link weighs nothing, and torques rest on what it weighs."""
    thigh = r'(?s)(<link name="thigh[123]">\s*)<inertial>.*?</inertial>'
    (note,) = source_of(str(written(BOX, tmp_path, thigh, r"\1"))).notes
    assert note == (
        "links without <inertial>, thigh1, thigh2 and 1 more, weigh as much as water "
        "in the shape of their <collision>: give them their mass"
    )


@pytest.mark.parametrize(("speed", "said"), [("0.1", "0.1"), ("2", "2"), ("2.1", "")])
def test_joints_that_are_to_turn_slower_than_they_will_are_named(tmp_path, speed, said):
    path = written(BOX, tmp_path, 'velocity="6"', f'velocity="{speed}"')
    notes = source_of(str(path)).notes
    assert len(notes) == bool(said)
    for note in notes:
        assert f" and 10 more are to turn at {said} rad/s at most" in note


@pytest.mark.parametrize(("end", "told"), [("6.2", False), ("45", True)])
def test_a_joint_whose_limits_are_in_degrees_is_named(tmp_path, end, told):
    ends = f'lower="-{end}" upper="{end}"'
    path = written(BOX, tmp_path, 'lower="[^"]*" upper="[^"]*"', ends)
    notes = [n for n in draft_card(source_of(str(path))).guesses if " may turn " in n]
    assert bool(notes) == told
    for note in notes:
        assert note.startswith(
            "joint 'yaw6' may turn by 5157 degrees: limits of a URDF"
        )


def test_a_robot_of_several_in_a_folder_is_named(tmp_path):
    ADOPTEES[0].write(tmp_path)
    assert source_of(str(tmp_path)).notes == ()
    (tmp_path / "worm.xml").write_text("<mujoco><!-- <freejoint/> --></mujoco>")
    (note,) = source_of(str(tmp_path)).notes
    assert note == "spider.xml, as worm.xml is a robot, too"


@pytest.mark.parametrize("shapes", ["collision", "visual"])  # which is written anew
def test_a_urdf_that_is_not_in_utf_8_is_refused_with_the_line(tmp_path, shapes):
    path = written(BOX, tmp_path, "collision>", f"{shapes}>")
    path.write_bytes(path.read_text().replace("yaw1", "h\xfcfte").encode("latin-1"))
    with pytest.raises(ModelError, match=r"byte 0xfc is no text .*box.urdf, line \d+;"):
        source_of(str(path))
