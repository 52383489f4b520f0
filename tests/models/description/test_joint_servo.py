"""Single servos on a robot's card: read as they are said, refused where impossible."""

from math import inf

import pytest

from models.description.card_file import parse_card
from models.description.robot import FOLDER
from models.description.servos import JointServo
from models.errors import ModelError

CARD = (FOLDER / "hexapod-classroom.toml").read_text()


def card(text):
    return parse_card(f"{CARD}\n{text}", "here")


def test_a_card_without_single_servos_has_none():
    assert parse_card(CARD, "here").joint_servos == {}


def test_what_is_said_of_a_servo_is_read_and_the_rest_left_open():
    read = card(
        "[servo.lift_2]\nchannel = 7\nsign = -1\noffset = 0.1\nlimits = [-0.5, 1]"
    )
    servo = read.joint_servos["lift_2"]
    assert (servo.channel, servo.sign, servo.offset) == (7, -1, 0.1)
    assert servo.limits == (-0.5, 1.0)
    assert servo.center is servo.counts_per_radian is None
    assert read.servo.made == "mg90"


def test_single_servos_alone_leave_the_joints_with_their_own():
    text = CARD.replace('[servo]\nkind = "mg90"', "[servo.lift_1]\ncenter = 300")
    read = parse_card(text, "here")
    assert read.servo is None
    assert read.joint_servos["lift_1"].center == 300


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[servo.lift_9]", "servo.lift_9: this joint is unknown; did you mean"),
        ("[servo.lift_1]\nsign = 2", "servo.lift_1: sign must be 1 or -1, got 2"),
        ("[servo.lift_1]\nchannel = -1", "channel must not be negative"),
        ("[servo.lift_1]\nchannel = 1.5", "channel must be a whole number"),
        ("[servo.lift_1]\ncenter = -3", "center must not be negative"),
        ("[servo.lift_1]\ncounts_per_radian = 0", "counts_per_radian must be positive"),
        ("[servo.lift_1]\nlimits = [1, -1]", "the lowest and the highest angle"),
        ("[servo.lift_1]\nlimits = [1, 1]", "the lowest and the highest angle"),
        ("[servo.lift_1]\nlimits = [1]", "the lowest and the highest angle"),
        ("[servo.lift_1]\nchanel = 1", "no key 'chanel'; did you mean 'channel'"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(text, said):
    with pytest.raises(ModelError, match=said):
        card(text)


def test_an_empty_table_of_servos_is_refused():
    text = CARD.replace('kind = "mg90"', "")
    with pytest.raises(ModelError, match=r"servo\.stiffness is missing"):
        parse_card(text, "here")


@pytest.mark.parametrize(
    "given",
    [
        {"limits": (-inf, 1.0)},
        {"limits": (0.0, inf)},
        {"counts_per_radian": inf},
        {"center": inf},
        {"offset": inf},
    ],
)
def test_what_is_endless_is_refused(given):
    with pytest.raises(ValueError, match="inf"):
        JointServo(**given)


def test_the_first_channel_and_the_first_count_are_zero():
    servo = JointServo(channel=0, center=0)
    assert (servo.channel, servo.center) == (0, 0)
