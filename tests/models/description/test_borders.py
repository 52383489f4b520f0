"""Borders of what a robot card may say: the last value that is taken, the first not."""

import re
from dataclasses import replace
from itertools import combinations
from math import inf, nan, nextafter

import pytest

from models.description.card import Card, GroupCard, LegCard, PatternCard, Servo
from models.description.robot import Robot
from models.description.servos import JointServo

CLOCKS = (20e6, 30e6)  # [Hz]; its data sheet's by a fifth more or less

LEG = LegCard("s", "l", ("f",))
GROUP = GroupCard({1: 1.0})
SERVO = Servo(1.0, 1.0)
CARD = Card(
    lift_angle=0.3,
    legs={1: LegCard("s1", "l1", ("f1",)), 2: LegCard("s2", "l2", ("f2",))},
    groups={"a": GroupCard({1: 1}), "b": GroupCard({2: 1})},
    gait=("ab", "a", "ab"),
)
MANY = {  # 33 strata of six groups
    "legs": {n: LegCard(f"s{n}", f"l{n}", (f"f{n}",)) for n in range(1, 7)},
    "groups": {g: GroupCard({n: 1}) for n, g in enumerate("abcdef", 1)},
    "gait": ["".join(s) for k in (6, 5, 4, 3) for s in combinations("abcdef", k)][:33],
}
PATTERN = PatternCard(("ab",), {"a": 1.0})
LOW, HIGH = CLOCKS
THIRD = 1 / 3

TAKEN = [
    (LEG, {"raise_sign": 1}), (LEG, {"raise_sign": -1}),
    (GROUP, {"legs": {1: 1e-6}}), (GROUP, {"legs": {1: -1e6}}),
    (GROUP, {"swing": (-1e-9, 1e-9)}),
    (SERVO, {"stiffness": 1e-9}), (SERVO, {"damping": 0.0}), (SERVO, {"armature": 0.0}),
    (CARD, {"lift_angle": 1e-9}), (CARD, {"lift_time": 1e9}),
    (CARD, {"board_clock": LOW}), (CARD, {"board_clock": HIGH}),
    (CARD, {"least_load": 0.0}), (CARD, {"least_load": nextafter(THIRD, 0)}),
    (CARD, {"gait": ("ab", "b", "ab")}), (CARD, {"gait": ("ab", "ab")}),
    (CARD, {"joint_servos": {"s1": JointServo()}}),
    (CARD, MANY | {"gait": (*MANY["gait"][:32], "abcdef")}),
    (CARD, {"patterns": {"turn": PATTERN}}),
]  # fmt: skip
REFUSED = [
    (LEG, {"raise_sign": 0}, "raise must be 1 or -1, got 0"),
    (LEG, {"foot": ()}, "foot names no geom"),
    (LEG, {"lift": "s"}, "swing and lift are the same joint, s"),
    (GROUP, {"legs": {}}, "a group needs at least one leg"),
    *((GROUP, {"legs": {1: 1, 2: v}}, "legs need a sign or a gain other than 0")
      for v in (0.99e-6, 0.0, -1.01e6, nan)),
    *((GROUP, {"swing": v}, "swing is the lowest angle, below 0, and the highest")
      for v in ((0.0, 1.0), (-1.0, 0.0), (0.1, 0.2))),
    (PATTERN, {"strata": ()}, "a pattern needs at least one stratum"),
    (PATTERN, {"groups": {}}, "a pattern needs at least one group"),
    (PATTERN, {"groups": {"c": 1.0}}, "groups ['c'] are in the air on Sab"),
    *((SERVO, {"stiffness": v}, f"stiffness must be positive, got {v}")
      for v in (0.0, -1.0, inf)),
    *((SERVO, {n: v}, f"{n} must not be negative, got {v}")
      for n in ("damping", "armature") for v in (-1e-9, inf)),
    (SERVO, {"data": {"volts": 5.0}}, "volts need a kind of servo; give kind"),
    (SERVO, {"made": "no-such"}, "kind 'no-such': it "),
    *((CARD, {n: v}, f"{n} must be positive, got {v}")
      for n in ("lift_angle", "lift_time") for v in (0.0, -1.0, inf)),
    *((CARD, {"board_clock": v}, "board.clock must be from 2e+07 to 3e+07 Hz, got ")
      for v in (nextafter(LOW, 0), nextafter(HIGH, inf))),
    (CARD, {"description": "two\nlines"}, "description must be one line of printable"),
    *((CARD, {"least_load": v}, "least_load is a share of the weight below 1/3, got ")
      for v in (-1e-9, THIRD)),
    (CARD, {"lift_time": 0.99e-3}, "lift_time must be 0.001 s or more"),
    (CARD, {"gait": ("ab", "a") * 500 + ("ab",)}, "1001 strata; 1000 are the most"),
    (CARD, {"legs": dict.fromkeys(range(1, 42), LEG)}, "41 legs; 40 are the most"),
    (CARD, {"legs": {1: LegCard("a", "b", ("f",) * 401)}}, "401 soles; 400 are the"),
    (CARD, {"patterns": dict.fromkeys(range(1001), PATTERN)}, "1001 patterns; 1000 a"),
    *((CARD, {"groups": dict.fromkeys(range(n + 1), GROUP), "patterns": patterns},
       f"{n + 1} groups; {n} are the most")
      for n, patterns in ((10, {}), (8, {"p": PATTERN}))),
    (CARD, {"patterns": {f"p{n}": PATTERN for n in range(41)}},
     "patterns swing on 41 strata; 40 at most"),
    (CARD, MANY | {"gait": (*MANY["gait"], "abcdef")}, "33 different strata; 32 are t"),
    (CARD, {"gait": ("ab",)}, "gait ['ab'] does not close; it ends with the stratum"),
    (CARD, {"gait": ("ab", "a")}, "gait ['ab', 'a'] does not close"),
    (CARD, {"gait": ("ab", "c", "ab")}, "gait: stratum 'c' stands on group 'c', which"),
    (CARD, {"gait": ("ab", "", "ab")}, "gait: a stratum is empty, with no foot on"),
    (CARD, {"gait": ("ab", "aa", "ab")}, "gait: stratum 'aa' must name its groups"),
    (CARD, {"groups": {"a": GroupCard({1: 1, 2: 1}), "b": GroupCard({2: 1})}},
     "leg 2 is in a and b; every leg belongs to exactly one group"),
    (CARD, {"groups": {"a": GroupCard({1: 1})}},
     "leg 2 is in no group; every leg belongs to exactly one group"),
    (CARD, {"groups": {"a": GroupCard({1: 1}), "b": GroupCard({2: 1, 3: 1})}},
     "group.b: there is no leg 3"),
    *((CARD, {"groups": {"a": GroupCard({1: 1}), n: GroupCard({2: 1})}},
       "names of groups are a letter or digit each, got ") for n in ("bc", "+", "")),
    (CARD, {"joint_servos": {"s3": JointServo()}}, "servo.s3: this joint "),
    (CARD, {"patterns": {"a b": PATTERN}}, "pattern 'a b': its name must be one word"),
    (CARD, {"patterns": {"p": PatternCard(("abc",), {"c": 1})}},
     "pattern p: there is no group ['c']"),
    (CARD, {"patterns": {"p": PatternCard(("b",), {"b": 1})}},
     "pattern p: the gait has no strata ['b']"),
]  # fmt: skip


@pytest.mark.parametrize(("part", "changes"), TAKEN)
def test_a_card_may_say_so(part, changes):
    changed = replace(part, **changes)
    for name, value in changes.items():
        assert getattr(changed, name) == value


@pytest.mark.parametrize(("part", "changes", "message"), REFUSED)
def test_a_card_may_not_say_so(part, changes, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        replace(part, **changes)


def test_what_a_card_leaves_out_is_as_usual():
    assert (LEG.raise_sign, LEG.hold, LEG.joints) == (1, {}, ("s", "l"))
    assert (GROUP.twist, GROUP.swing) == (None, None)
    assert (CARD.lift_time, CARD.least_load, CARD.servo) == (0.3, 0.0, None)
    assert (CARD.patterns, CARD.joint_servos, CARD.start) == ({}, {}, {})
    assert (CARD.bottom, CARD.strata) == ("ab", ("ab", "a"))
    assert CARD.group_of_leg == {1: 0, 2: 1}


def test_a_servo_is_written_with_its_rotor_if_it_has_one():
    assert str(Servo(80.0, 1.25)) == "80 N m/rad, 1.25 N m s/rad"
    whole = Servo(80.0, 1.25, armature=0.00125)
    assert str(whole) == "80 N m/rad, 1.25 N m s/rad and rotors of 0.00125 kg m^2"
    assert Servo(80.0, 1.25).settings == {"stiffness": 80.0, "damping": 1.25}
    assert whole.settings["armature"] == 0.00125


def test_a_robot_is_read_without_its_card_but_with_its_other_texts(tmp_path):
    path = tmp_path / "own.xml"
    texts = '<custom><text name="card" data="a"/><text name="note" data="b"/></custom>'
    path.write_text(f"<mujoco>{texts}<worldbody><body/></worldbody></mujoco>")
    spec = Robot("own", path, "", None).read()
    assert [text.name for text in spec.texts] == ["note"]
