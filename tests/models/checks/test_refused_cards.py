"""What a robot card cannot say, and what is said about it."""

import pytest

from models.description.card_file import parse_card
from models.description.robot import FOLDER
from models.errors import ModelError

CARD = (FOLDER / "hexapod.toml").read_text()
STRATA = '["12", "1", "12", "2", "12"]'
LEG = '1 = { swing = "swing_1", lift = "lift_1", raise = 1, foot = ["foot_1"] }'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("lift_angle = 0.3", "lift angle", r"Expected '=' after a key.*line 2"),
        ("lift_angle = 0.3", "", "lift_angle is missing"),
        ("= 0.3", "= nan", "lift_angle must be a number, got nan"),
        ("= 0.3", '= "high"', "lift_angle must be a number, got 'high'"),
        ("= 0.3", "= -0.3", "lift_angle must be positive, got -0.3"),
        (
            "t_angle",
            "t_angel",
            "file has no key 'lift_angel'; did you mean 'lift_a",
        ),
        ("description =", "description = 1 #", "description must be a text, got 1"),
        (LEG, '1 = "swing_1"', "leg.1 must be a table, got 'swing_1'"),
        (LEG, LEG.replace("1 =", "front =", 1), "leg.front: legs have numbers"),
        (LEG, LEG.replace("1 =", "01 =", 1), "leg.01: legs have numbers"),
        ('swing = "swing_1", ', "", "leg.1.swing is missing"),
        ('swing = "swing_1"', "swing = 1", "leg.1.swing must be a text, got 1"),
        ('"swing_1"', '"lift_1"', "leg.1: swing and lift are the same joint, lift_1"),
        ("raise = 1", "raise = 2", "leg.1: raise must be 1 or -1, got 2"),
        ("raise = 1", "raise = 1.7", "leg.1: raise must be 1 or -1, got 1.7"),
        ('["foot_1"]', '"foot_1"', "leg.1.foot must be a list of texts, got 'foot_1'"),
        ('["foot_1"]', "[]", "leg.1: foot names no geom"),
        (
            '["foot_1"]',
            '["foot_1"], hold = { knee = "x" }',
            "knee must be a number",
        ),
        ("1 = -1, 4", "1 = 0, 4", r"group.1: legs need a sign or a gain .* \{1: 0.0\}"),
        (
            "2 = 1, 3",
            "1 = 1, 2 = 1, 3",
            "leg 1 is in 1 and 2; every leg belongs to ex",
        ),
        (", 6 = 1", "", "leg 6 is in no group; every leg belongs to exactly one"),
        (", 6 = 1", ", 6 = 1, 7 = 1", "group.2: there is no leg 7"),
        ("{ 2 = 1, 3 = 1, 6 = 1 }", "[2, 3, 6]", "group.2.legs must be a table"),
        ("[group.1]", "[group.left]", "names of groups are a letter or digit each"),
        ("[group.1]", '[group."+"]', "names of groups are a letter or digit each"),
        ("[group.1]", "[group.1]\ntwist = [1, 2]", "group.1.twist is forward, left"),
        (f"strata = {STRATA}", "", "gait.strata is missing"),
        (
            STRATA,
            '["21", "1", "21", "2", "21"]',
            "stratum '21' must name its groups once each and in their order",
        ),
        (STRATA, '"12"', "gait.strata must be a list of texts, got '12'"),
        (
            '"2", "12"]',
            '"2"]',
            r"gait \['12', '1', '12', '2'\] does not close",
        ),
        (
            '"12", "2"',
            '"12", "3"',
            "stands on group '3', which does not exist",
        ),
        (
            '"12", "2"',
            '"12", ""',
            "gait: a stratum is empty, with no foot on the",
        ),
        ("[gait]", "[servo]\nstifness = 1\n[gait]", "did you mean 'stiffness'"),
        ("[gait]", "[servo]\ndamping = 1\n[gait]", "servo.stiffness is missing"),
        (
            "[gait]",
            "[servo]\nstiffness = -1\ndamping = 1\n[gait]",
            "servo: stiffness must be positive, got -1",
        ),
        (
            "[gait]",
            '[pattern.turn]\nstrata = ["1"]\ngroups = { 2 = 1 }\n[gait]',
            r"pattern.turn: groups \['2'\] are in the air on S1",
        ),
    ],
)
def test_an_impossible_card_is_refused_by_its_reason(old, new, message):
    assert old in CARD
    with pytest.raises(ModelError, match=f"^bad robot card: here; .*{message}"):
        parse_card(CARD.replace(old, new, 1), "here")
