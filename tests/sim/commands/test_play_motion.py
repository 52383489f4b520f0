"""`stratawalk play`: files of joint motion become run folders, in any unit."""

import json
from pathlib import Path

import numpy as np
import pytest

from models import load
from sim.cli import main
from sim.runs.run import read_run

JOINTS = [f"{kind}_{leg}" for leg in range(1, 7) for kind in ("swing", "lift")]


@pytest.fixture
def gait(tmp_path, monkeypatch):
    """Write a short gait: tripod 2 is lifted, and tripod 1 strokes."""
    monkeypatch.chdir(tmp_path)

    def make(scale=1.0, offset=0.0, name="gait.csv"):
        time = np.arange(41) / 50
        part = np.clip(time / 0.8, 0, 1)
        rows = [time]
        for joint in JOINTS:
            tripod = 1 if joint[-1] in "145" else 2
            lift = 0.2 * np.sin(np.pi * part) ** 2 * (tripod == 2)
            swing = 0.1 * np.sin(np.pi * (part - 0.5)) * (tripod == 1)
            rows.append(offset + scale * (swing if joint[0] == "s" else lift))
        names = ",".join(["time", *JOINTS])
        np.savetxt(
            tmp_path / name, np.transpose(rows), "%.9g", ",", "\n", names, "", ""
        )
        return name

    return make


FAST = (
    "--no-video",
    "--set",
    "timestep=0.002",
    "--set",
    "predictions=['quasi_static']",
)


@pytest.mark.parametrize("key", ["robot", "motion"])
def test_what_the_words_of_the_command_name_is_not_set_too(gait, capsys, key):
    assert main(["play", "hexapod", gait(), "--set", f"{key}=octopod", *FAST]) == 2
    assert f"{key} is given twice: --set {key}; keep one" in capsys.readouterr().err


def test_a_log_that_a_scenario_plays_is_told_of_as_one_that_is_played(gait, capsys):
    """One in degrees goes beyond the range of the joints."""
    given = f'robot = "hexapod"\nmotion = "{gait(20.0)}"\nfeed_forward = false\n'
    Path("mine.toml").write_text(given)
    told = []
    for words in (["play", "hexapod", "gait.csv"], ["run", "mine.toml"]):
        main([*words, "--out", words[0], *FAST])
        said = capsys.readouterr().err.splitlines()
        told.append([line for line in said if "beyond" in line or "end of its" in line])
    assert told[0] == told[1] != []


def test_a_gait_in_degrees_and_in_counts_is_the_same_motion(gait, capfd):
    found = []
    for units, scale, offset in (
        ("radians", 1.0, 0.0),
        ("degrees", np.degrees(1), 0.0),
        ("counts", 4096 / (2 * np.pi), 2048.0),
    ):
        file = gait(scale, offset)
        words = ["play", "hexapod", file, "--units", units, "--out", units, *FAST]
        assert main([*words, "--json"]) == 0
        said = capfd.readouterr()
        found.append(json.loads(said.out)["achieved"]["pose"])
    taken = "4096 counts a turn are taken, 2048 at angle zero"
    assert f"notice: the card gives no servo of 'swing_1'; {taken}" in said.err
    np.testing.assert_allclose(found[1:], [found[0]] * 2, atol=1e-6)
    assert abs(found[0][2]) > 0.1


def test_pulses_in_microseconds_are_angles_by_the_servo_table_of_the_card(
    gait, tmp_path, capfd
):
    """Two joints: one mounted the other way round, and one as its make comes."""
    robot = load("hexapod-classroom")
    (tmp_path / "mine.xml").write_text(robot.read().to_xml())
    own = "[servo.swing_1]\nsign = -1\ncenter = 371\noffset = 0.05\n"
    (tmp_path / "mine.toml").write_text(f"{robot.card_text}\n{own}")
    told = np.loadtxt(tmp_path / gait(), delimiter=",", skiprows=1)
    pulses, count = told.copy(), 102 / 25  # of a PCA9685 that gives nearly 60 Hz
    a_radian = 350 / 4096 / 60 * 1e6 / np.pi  # of an MG90, whose half turn is 1.42 ms
    pulses[:, 1:] = 364 * count + a_radian * told[:, 1:]
    pulses[:, 1] = 371 * count - a_radian * (told[:, 1] - 0.05)
    names = ",".join(["time", *JOINTS])
    np.savetxt(tmp_path / "us.csv", pulses, "%.9g", ",", "\n", names, "", "")
    words = ["play", "mine.xml", "us.csv", "--units", "microseconds", "--out", "run"]
    assert main([*words, *FAST, "--tolerance", "none"]) in (0, 4)
    taken = f"no servo of 'lift_1'; {2 * np.pi * a_radian:.0f} microseconds a turn"
    assert taken in capfd.readouterr().err
    found = np.loadtxt(tmp_path / "run" / "motion.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(found, told, atol=1e-6)


def test_a_joint_that_the_robot_lacks_is_named(gait, capfd, tmp_path):
    text = (tmp_path / gait()).read_text().replace("swing_3", "swnig_3")
    (tmp_path / "wrong.csv").write_text(text)
    assert main(["play", "hexapod", "wrong.csv", "--no-video"]) == 2
    error = capfd.readouterr().err
    assert (
        "the robot has no joint 'swnig_3': wrong.csv; did you mean 'swing_3'" in error
    )
    assert not (tmp_path / "runs").exists()


def test_a_played_motion_beyond_its_tolerance_ends_with_7(gait, capfd):
    slippery = ["--set", "friction=0.05", "--set", "swing_speed=1"]
    words = ["play", "hexapod", gait(), *FAST, *slippery, "--tolerance", "1e-6"]
    assert main(words) == 7
    assert "off the quasi-static prediction" in capfd.readouterr().err


def test_the_example_is_played_twice_over(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    example = Path(__file__).parents[3] / "examples" / "tripods.csv"
    assert (
        main(["play", "hexapod", str(example), *FAST, "--repeat", "2", "--json"]) == 0
    )
    summary = json.loads(capfd.readouterr().out)
    assert "goal" not in summary
    assert summary["simulated_time"] == pytest.approx(0.5 + 3.2, abs=0.01)
    assert summary["achieved"]["pose"][0] == pytest.approx(0.036, abs=0.002)
    motion = tmp_path / "runs" / "tripods-001" / "motion.csv"
    assert len((text := motion.read_text()).splitlines()) == 162
    motion.write_text(text.replace("0.05", "0.04"))
    for command in ("fit", "sensitivities", "show"):  # which would speak of another one
        assert main([command, str(motion.parent)]) == 2
        assert "its files are of different walks" in capfd.readouterr().err


def test_legs_that_throw_the_robot_are_predicted_without_an_error_of_ours(gait, capfd):
    name = gait()
    time, *angles = np.loadtxt(name, delimiter=",", skiprows=1).T
    thrown = np.where(np.arange(6) % 2, -0.4, 0.4)[:, None] + np.zeros(len(angles))
    names = ",".join(["time", *JOINTS])
    rows = np.column_stack([time[:6], thrown])
    np.savetxt("thrown.csv", rows, "%.9g", ",", "\n", names, "", "")
    sets = "timestep=0.002", "predictions=['quasi_static', 'compliant']"
    words = [word for one in sets for word in ("--set", one)]
    assert main(["play", "hexapod", "thrown.csv", "--no-video", *words]) in (0, 7)
    (summary,) = Path("runs").glob("*/summary.json")
    predicted = json.loads(summary.read_text())["predicted"]
    assert all(np.isfinite(one["min_margin"]) for one in predicted.values())


@pytest.mark.physics
def test_runs_in_which_feet_of_no_group_stand_are_read_and_not_planned(
    tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("l.csv").write_text("time,lift_1\n0,0\n0.5,0.3\n1,0.0\n")
    assert main(["play", "hexapod", "l.csv", "--no-video", "--out", "p"]) == 0
    assert any(
        "legs 2 3 4 5 6" in phase.stratum for phase in read_run(Path("p")).phases
    )
    capsys.readouterr()
    assert main(["plan", "p/scenario.toml"]) == 2
    assert "it plays a motion, and nothing is planned" in capsys.readouterr().err
    assert main(["drive", "p/scenario.toml"]) == 2
    assert "is for a whole path, and drive plans piece by" in capsys.readouterr().err
