"""A robot in numbers, as `stratawalk robots ROBOT` shows it."""

import json
from dataclasses import replace
from math import cos, sin
from shutil import copy

import pytest

from models import load
from sim import cli
from sim.preparation.inspection import inspected
from sim.scenarios.file import load_scenario
from sim.templates import render
from tests import foreign


def test_the_hexapod_has_the_numbers_of_its_design(scenario):
    found = inspected(scenario(), load("hexapod"))
    assert found["mass"] == pytest.approx(1.27)
    assert found["legs"]["1"]["foot"] == pytest.approx([0.15, 0.18])
    assert found["legs"]["1"]["swing"] == {"joint": "swing_1", "range": [-0.45, 0.45]}
    assert found["fields"]["g1_1"] == pytest.approx([0.0378, 0.0, 0.56])
    assert found["margins"]["1"] == pytest.approx(0.0537, abs=5e-5)  # as printed there
    # the middle of a foot 0.105 m from the hip and 0.052 m below it, turned by 0.3 rad
    rise = 0.105 * sin(0.3) + 0.052 * (1 - cos(0.3))
    assert found["lift"]["height"] == pytest.approx(rise)
    assert found["lift"]["highest"] > found["lift"]["height"]


def test_a_robot_of_ones_own_is_shown_leg_by_leg(scenario, tmp_path):
    robot = str(foreign.mantis(tmp_path))
    facts = inspected(scenario(robot=robot), load(robot))
    lines = render("robot.txt", **facts).splitlines()
    (first,) = (line for line in lines if line.startswith("1 ") and "lf_1" in line)
    assert first.endswith("lf_2 -1.4 to 1.4, lf_3 held at 0.1")
    assert "gait        12 1 12 2 12, the groups of legs that stand in turn" in lines


@pytest.mark.parametrize(("robot", "outside"), [("hexapod", 0), ("quadruped", 1)])
def test_a_negative_margin_at_rest_is_explained_where_there_is_one(
    scenario, robot, outside
):
    text = render("robot.txt", **inspected(scenario(robot=robot), load(robot)))
    assert text.count("from the centre of mass at rest to the edge") == 1
    assert text.count("the robot must move its body before it lifts a foot") == outside


@pytest.mark.parametrize(("stiffness", "name"), [(100.0, "own"), (1000.0, "ideal")])
def test_soft_servos_of_a_file_are_told_as_its_own_with_their_stiffness(
    tmp_path, stiffness, name
):
    robot, path = load("hexapod"), tmp_path / "soft.xml"
    path.write_text(robot.path.read_text().replace('kp="1000"', f'kp="{stiffness}"'))
    copy(robot.path.with_name("scene.xml"), tmp_path)
    path.with_suffix(".toml").write_text(robot.card_text)
    one = load_scenario("line", {"robot": str(path)})
    text = render("robot.txt", **inspected(one, load(str(path))))
    assert f"servos      {name}, {stiffness:g} N m/rad, without a largest tor" in text


@pytest.mark.parametrize(
    ("servo", "told", "some"),
    [
        ("ideal", "without a largest torque, unlike any real servo", "mg996r"),
        ("mg996r", "at most 1.08 N m, perhaps too weak to walk", "mg996r"),
    ],
)
def test_servos_and_makes_are_told_by_what_they_can_carry(scenario, servo, told, some):
    text = render("robot.txt", **inspected(scenario(servo=servo), load("hexapod")))
    servos, makes = (
        next(line for line in text.splitlines() if line.startswith(head))
        for head in ("servos ", "makes ")
    )
    assert told in servos
    enough, _, perhaps = makes.partition("; for some walks: ")
    assert "for every walk: ax-12" in enough
    assert perhaps.startswith(f"{some}; `run` says")


def test_the_command_shows_one_robot_or_why_it_cannot_be_used(tmp_path, capsys):
    path = foreign.mantis(tmp_path)
    assert cli.main(["robots", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "mantis"
    card = path.with_suffix(".toml")
    card.write_text(card.read_text().replace("raise = -1", "raise = 1"))
    assert cli.main(["robots", str(path)]) == 3
    assert (
        "leg 1: raise = 1 makes joint 'lf_2' lower its foot" in capsys.readouterr().err
    )


def test_servos_are_shown_as_they_were_fitted():
    robot = load("hexapod-classroom")
    robot = replace(robot, card=replace(robot.card, fitted={"servo_stiffness": 7.46}))
    servos = inspected(load_scenario("line"), robot)["servos"]
    assert (servos["name"], servos["stiffness"]) == ("mg90", 7.46)
