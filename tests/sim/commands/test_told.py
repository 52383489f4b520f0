"""What walks and robots do wrong is said: divergence, softness, starts, caps."""

import numpy as np
import pytest

from sim.evaluation.quantities import describe
from sim.scenarios.body_path import line
from tests.commands import refusal, told
from tests.walks import simulated

SHORT = ("run", "line", "--segments", "2", "--no-video", "--out", "here")
GOAL = ("--set", "path.goal=[0.01, 0.01, 0]")


def sets(*words):
    return [part for word in words for part in ("--set", word)]


@pytest.mark.physics
def test_a_divergence_leaves_what_led_to_it_and_says_how_to_see_it_again(
    stratawalk, tmp_path
):
    wild = sets("timestep=0.01", "servo_stiffness=1e6", "servo_damping=0")
    done = stratawalk(*SHORT, *GOAL, *wild)
    assert done.returncode == 4
    said = refusal(done)
    assert "diverged at joint 'lift_3', warning BADQACC: t = 0.03" in said
    assert (tmp_path / "here" / "commands.npz").exists()
    assert not (tmp_path / "here" / "summary.json").exists()
    again = said.rpartition("walk again: stratawalk ")[2].split()
    assert stratawalk(*again, "--out", "again").returncode == 4
    states = [np.load(tmp_path / name / "divergence.npz") for name in ("here", "again")]
    assert 0 < len(states[0]["time"]) <= 100
    assert len(states[0]["qpos"]) == len(states[0]["qvel"]) == len(states[0]["time"])
    steps = 1 + np.arange(len(states[0]["time"]))  # all of them, since there are few
    assert states[0]["time"] == pytest.approx(0.01 * steps)
    for name in ("time", "qpos", "qvel"):
        assert np.array_equal(states[0][name], states[1][name])


SOFT = {
    "servos too soft to lift": (["servo_stiffness=1e-9"], 3, "bend by more than lift"),
    "a timestep too long": (["timestep=0.004"], 2, "give at most 0.002, at which the"),
    "a load of a ton": (
        ["payload=[1e3,0,0,0]"],
        2,
        "hexapod does not stand with payload = (1000.0, 0.0, 0.0, 0.0): scenario ",
    ),
    "a floor too soft": (
        ["floor_stiffness=100", "backlash=0.001"],
        2,
        "stand with backlash = 0.001, floor_stiffness = 100.0: scenario 'line'; change",
    ),
    "servos too soft on any floor": (
        ["servo_stiffness=1e-9", "floor_stiffness=9e4"],
        3,
        "bend by more than lift",
    ),
}


@pytest.mark.physics
@pytest.mark.parametrize(("settings", "code", "said"), SOFT.values(), ids=SOFT)
def test_settings_under_which_nothing_can_stand_are_named(
    stratawalk, settings, code, said
):
    done = stratawalk(*SHORT, *GOAL, *sets(*settings))
    assert done.returncode == code
    *notices, last = told(done.stderr)
    assert said in last
    assert all("notice: predictions ignore" in notice for notice in notices)


@pytest.mark.physics
def test_a_speed_that_the_acceleration_caps_is_told(scenario):
    told = describe(simulated(scenario(swing_speed=6.0)).summary)
    assert "swing_acceleration caps the swing_speed of 6" in told


@pytest.mark.physics
def test_nothing_caps_the_speed_of_a_walk_without_swings(scenario):
    still = describe(simulated(scenario(path=line((0.0, 0.0, 0.0)))).summary)
    assert "swing_acceleration" not in still


STARTS = {
    "in the air": (
        "0 0 0.5 1 0 0 0",
        "let down onto the floor by 440.0 mm: at the angles of its start, its feet "
        "would be above the floor where its file puts the body",
    ),
    "in the ground": (
        "0 0 0.03 1 0 0 0",
        "lifted out of the floor by 30.0 mm: at the angles of its start, its feet "
        "would be below the floor where its file puts the body",
    ),
}


@pytest.mark.parametrize(("qpos", "said"), STARTS.values(), ids=STARTS)
def test_a_robot_that_is_moved_at_its_start_is_told(stratawalk, robot, qpos, said):
    done = stratawalk("robots", robot("0 0 0.06 1 0 0 0", qpos))
    assert (done.returncode, done.stderr) == (0, "")
    assert said in done.stdout


def test_a_quaternion_of_zeros_is_no_way_to_stand(stratawalk, robot):
    done = stratawalk("robots", robot("0 0 0.06 1 0 0 0", "0 0 0.06 0 0 0 0"))
    assert done.returncode == 3
    assert "'start' has a quaternion of zeros for joint 'root'" in refusal(done)


def test_a_keyframe_of_zeros_names_the_body_of_a_joint_without_name(
    stratawalk, robot, tmp_path
):
    path = tmp_path / robot("0 0 0.06 1 0 0 0", "0 0 0.06 0 0 0 0")
    path.write_text(
        path.read_text().replace('<freejoint name="root"/>', "<freejoint/>")
    )
    said = refusal(stratawalk("robots", str(path)))
    assert "has a quaternion of zeros for body 'torso'" in said
