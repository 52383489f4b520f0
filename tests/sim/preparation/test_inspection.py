"""`stratawalk robots FILE`: numbers of robots that cannot walk, and why they cannot."""

import json

import pytest

from sim import cli
from tests import radial


@pytest.fixture
def shown(capsys):
    """What the command says of a robot that it can look at."""

    def run(path):
        assert cli.main(["robots", str(path)]) == 0
        text = capsys.readouterr().out
        assert cli.main(["robots", str(path), "--json"]) == 0
        return text, json.loads(capsys.readouterr().out)

    return run


def test_brackets_that_vanish_are_explained_and_another_posture_was_tried(
    shown, tmp_path
):
    text, facts = shown(radial.write(tmp_path))
    assert "1.300 kg" in text
    body, legs = 1.0 * 0.078, 6 * 0.05 * 0.01  # masses and heights; feet end at 0.002
    assert facts["weight_height"] == pytest.approx((body + legs) / 1.3 - 0.002)
    assert facts["fields"]["g1_1"] == pytest.approx([0, 0, -0.5705], abs=1e-4)
    reason, remedy = facts["lacks"]
    assert reason.startswith("it cannot go forward or go sideways: both strokes turn")
    assert "strokes a metre forward" in remedy
    assert reason in text


def test_servo_that_the_card_lacks_is_proposed_and_the_robot_stands_with_it(
    shown, tmp_path
):
    text, facts = shown(radial.write(tmp_path, servo=""))
    assert "1.300 kg" in text
    assert "joints 'swing_1', 'lift_1', 'swing_2', ... have no position servo" in text
    told = facts["lacks"][0].split("write [servo] with ")[1].split(", with which")[0]
    assert [row.split(" = ")[0] for row in told.split(", ")] == [
        "stiffness", "damping", "armature",
    ]  # fmt: skip
    servo = "\n".join(["[servo]", *told.split(", "), ""])
    assert (
        "servo" not in shown(radial.write(tmp_path, servo=servo))[0].split("lacks")[1]
    )


def test_gait_that_steers_nothing_is_explained(shown, tmp_path):
    text, facts = shown(radial.write(tmp_path, gait='["12", "1", "12"]'))
    assert facts["fields"] == {}
    assert "steering needs two swings of standing legs" in text
    assert facts["margins"]["1"] > 0


def test_robot_that_lies_upside_down_stays_refused(tmp_path, capsys):
    path = radial.write(tmp_path)
    path.write_text(path.read_text().replace("0 0 0.06", '0 0 0.06" euler="180 0 0'))
    assert cli.main(["robots", str(path)]) == 3
    assert "starts upside down" in capsys.readouterr().err


def test_torque_that_the_file_allows_its_servos_is_their_limit(shown, tmp_path):
    path = radial.write(tmp_path, servo="")
    servos = "".join(
        f'<position joint="{kind}_{leg}" kp="1000" kv="3" forcerange="-{most} {most}"/>'
        for leg in radial.BEARINGS
        for kind, most in (("swing", 9), ("lift", 0.2 + 0.01 * leg))
    )
    text = path.read_text().replace(
        "</mujoco>", f"<actuator>{servos}</actuator></mujoco>"
    )
    path.write_text(text)
    text, facts = shown(path)
    assert facts["servos"]["torque"] == pytest.approx(0.21)  # of leg 1, the weakest
    assert "at most 0.21 N m" in text
