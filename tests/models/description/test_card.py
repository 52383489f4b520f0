"""What a robot card lists, in the order of the legs' numbers."""

from dataclasses import replace

import pytest

from models import load
from models.description.card import Card, GroupCard, LegCard
from models.description.card_file import card_text
from models.errors import ModelError


def leg(number):
    return LegCard(f"swing_{number}", f"lift_{number}", (f"foot_{number}",))


CARD = Card(
    lift_angle=0.3,
    legs={2: leg(2), 1: leg(1), 3: leg(3)},
    groups={"a": GroupCard({3: 1, 1: 1}), "b": GroupCard({2: -1})},
    gait=("ab", "a", "ab"),
)


def test_legs_are_listed_in_ascending_order_whatever_the_order_of_the_file():
    numbers = ("1", "2", "3")
    joints = [joint for n in numbers for joint in (f"swing_{n}", f"lift_{n}")]
    assert CARD.joints == tuple(joints)
    assert CARD.feet == tuple(f"foot_{n}" for n in numbers)
    assert list(CARD.group_of_leg.items()) == [(1, 0), (2, 1), (3, 0)]


@pytest.mark.parametrize("name", ["time", "measured.lift_1", "body.x", "contact.1"])
def test_no_joint_is_called_as_a_column_of_logs_is(name):
    """Its commands would be read as what another joint did."""
    legs = CARD.legs | {1: LegCard(name, "lift_1", ("foot_1",))}
    with pytest.raises(ValueError, match=f"joint '{name}' is called as a column"):
        replace(CARD, legs=legs)
    replace(CARD, legs=CARD.legs | {1: LegCard("timer", "contact", ("foot_1",))})


def test_a_card_has_a_megabyte_at_most(tmp_path):
    """It is read more than once, and 10 MB of comments take 6 s each time."""
    path = tmp_path / "mine.toml"
    path.write_text("#" * 10**6)
    assert len(card_text(path)) == 10**6
    path.write_text("#" * (10**6 + 1))
    with pytest.raises(ModelError, match="^bad robot card: .*; larger than 1 MB$"):
        card_text(path)


def test_legs_that_are_grouped_anew_turn_as_far_as_in_the_groups_that_they_leave():
    robot = load("hexapod")
    groups = {
        "1": GroupCard({1: 1.0, 4: -1.0, 5: 1.0}, swing=(-0.1, 0.2)),
        "2": GroupCard({2: 1.0, 3: 0.5, 6: 1.0}),
    }
    robot = replace(robot, card=replace(robot.card, groups=groups))
    made = robot.alternating({"a": {1: 1.0, 2: 1.0, 3: 1.0}, "b": {4: 1, 5: 2, 6: 1}})
    assert made.card.groups["a"].swing == (-0.1, 0.2)  # of leg 1 alone
    assert made.card.groups["b"].swing == (-0.05, 0.1)  # of both, 4 turned round
    assert made.swing_range["a"] == (-0.1, 0.2)
    plain = robot.alternating({"a": {2: 1.0, 3: 1.0, 6: 1.0}, "b": {1: 1, 4: 1, 5: 1}})
    assert plain.card.groups["a"].swing is None
