"""A robot in another process is driven by commands and poses alone."""

import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from models.description import FOLDER
from sim.cli import main
from sim.commands.drive import Link, Poses, _opened
from sim.export.served import served

ROBOT = Path(__file__).with_name("imperfect_robot.py")
SETTINGS = {
    "segments": 2,
    "path.goal": [0.008, 0.0, 0.0],
    "sense": "tag",
    "sense_position": 0.0002,
    "sense_yaw": 0.001,
    "sense_readings": 4,
}


def way(changes=None):
    """The command, with some settings changed."""
    given = (f"{key}={value}" for key, value in (SETTINGS | (changes or {})).items())
    pairs = (("--set", one) for one in given)
    return ["drive", "line", "--pace", "0", *(word for pair in pairs for word in pair)]


def driven(changes=None, noise=0.0002):
    """Where the imperfect robot ends, driven through two pipes, and what drive says."""
    there, back = os.pipe(), os.pipe()
    robot = subprocess.Popen(
        [sys.executable, ROBOT, str(noise)],
        stdin=there[0],
        stdout=back[1],
        stderr=subprocess.PIPE,
        text=True,
    )
    drive = subprocess.run(
        [sys.executable, "-m", "sim.start", *way(changes)],
        stdin=back[0],
        stdout=there[1],
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    for end in there:
        os.close(end)
    told = robot.communicate()[1]
    for end in back:
        os.close(end)
    return json.loads(told.splitlines()[-1]), drive


def off(pose, goal):
    return float(np.hypot(*np.subtract(pose[:2], goal)))


@pytest.mark.physics
def test_a_robot_elsewhere_goes_by_the_poses_it_sends():
    pose, drive = driven()
    assert drive.returncode == 0, drive.stderr
    words = re.search("segment 2 of 2: estimated at (.*) m, (.*) m", drive.stderr)
    # four readings of 0.2 mm; the robot stands still for half a second after them
    assert off(pose, [float(word) for word in words.groups()]) < 0.5e-3


@pytest.mark.full
@pytest.mark.physics
def test_a_robot_elsewhere_is_brought_nearer_to_the_goal_than_a_blind_one():
    far = {"segments": 10, "path.goal": [0.04, 0.0, 0.0]}
    seen, blind = driven(far)[0], driven(far | {"sense_until": 0})[0]
    assert off(seen, (0.04, 0)) < 0.5 * off(blind, (0.04, 0))


@pytest.mark.parametrize("pace", [0.5, 1.0, 4.0])
def test_commands_come_at_their_times_divided_by_the_pace(monkeypatch, pace):
    clock, sent = [7.0], []

    def sleep(seconds):
        clock[0] += seconds

    monkeypatch.setattr("time.monotonic", lambda: clock[0])
    monkeypatch.setattr("time.sleep", sleep)
    commands = SimpleNamespace(
        write=lambda _: None, flush=lambda: sent.append(clock[0])
    )
    link = Link(Poses(io.StringIO()), commands, pace, patience=1.0)
    rows = [(when, np.zeros(1)) for when in (0.0, 0.02, 0.5, 3.0)]
    walk = SimpleNamespace(joints=("swing_1",), rate=50.0)
    link.send(walk, rows)
    assert np.multiply(pace, np.subtract(sent, 7.0)) == pytest.approx([0, 0.02, 0.5, 3])


@pytest.mark.parametrize("pace", [0.5, 1.0, 4.0])
def test_a_robot_goes_on_from_where_it_stands_after_a_pause(
    monkeypatch, pace, scenario
):
    """As of planning, or of a process that was stopped, and in time with its clock."""
    clock, sent = [7.0], []

    def sleep(seconds):
        clock[0] += seconds

    monkeypatch.setattr("time.monotonic", lambda: clock[0])
    monkeypatch.setattr("time.sleep", sleep)
    commands = io.StringIO()
    commands.flush = lambda: sent.append(clock[0])
    walk = served(scenario(segments=1))
    link = Link(Poses(io.StringIO()), commands, pace, patience=1.0)

    def paused(rows, at):
        for number, row in enumerate(rows):
            clock[0] += 3.01 / pace if number == at else 0.0
            yield row

    link.send(walk, walk.stand())
    link.send(walk, paused(walk.walk(0), 20))
    told = [json.loads(line)["time"] for line in commands.getvalue().splitlines()]
    assert np.multiply(pace, np.subtract(sent, 7.0)) == pytest.approx(told, abs=0.021)
    period = 1 / walk.rate
    gaps = np.diff(told) / period
    assert sorted(np.round(gaps).tolist())[-2:] == [1.0, int(3.01 / period)]
    assert np.diff(sent).min() >= 0.4 * period / pace


@pytest.mark.timeout(60)  # it waited for ever
@pytest.mark.physics
def test_old_poses_that_never_end_are_no_reason_to_wait():
    """As of a camera whose clock stands still."""
    told = '{"time": 0, "x": 0, "y": 0, "yaw": 0}'
    words = shlex.join([*way(), "--patience", "0.1"])
    drive = subprocess.run(
        f"yes {shlex.quote(told)} | {sys.executable} -m sim.start {words} > /dev/null",
        shell=True, stderr=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    assert drive.returncode == 0, drive.stderr
    assert "no pose came" in drive.stderr


def test_a_robot_that_stops_listening_ends_the_walk_with_a_message(tmp_path, capfd):
    drive = subprocess.run(
        f"{sys.executable} -m sim.start {shlex.join(way())} < /dev/null | head -n 3",
        shell=True,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "the robot stopped listening: t = " in drive.stderr


def test_an_interrupted_drive_says_what_was_sent_and_gives_a_command_that_works(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Link, "reading", interrupted)
    assert main([*way(), "--poses", os.devnull, "--commands", "sent.jsonl"]) == 130
    said = capsys.readouterr().err.splitlines()[-1]
    assert "sent.jsonl holds the commands that were sent; start again: " in said
    assert said.endswith("--commands sent-2.jsonl")
    assert main([*way(), "--poses", os.devnull, "--commands", os.devnull]) == 130
    said = capsys.readouterr().err.splitlines()[-1]
    assert "holds" not in said
    assert said.endswith(f"--commands {os.devnull}")


def test_the_card_of_another_robot_is_not_driven_by_without_a_word(
    tmp_path, monkeypatch, capsys
):
    for name, file in (("hexapod.xml", "mine.xml"), ("scene.xml", "scene.xml")):
        shutil.copy(FOLDER / name, tmp_path / file)
    monkeypatch.setattr("sys.stdin", io.StringIO())
    assert main([*way(), "--robot", str(tmp_path / "mine.xml")]) == 0
    assert "mine.xml has no card; that of the shipped robot" in capsys.readouterr().err


def test_a_file_of_poses_that_is_not_there_is_refused(capsys):
    assert main([*way(), "--poses", "nowhere.jsonl"]) == 6
    assert "nowhere.jsonl; name a file, a pipe, or -" in capsys.readouterr().err


def test_no_file_is_written_over_with_commands(tmp_path, capsys):
    path = tmp_path / "mine"
    path.write_text("mine")
    assert main([*way(), "--commands", str(path)]) == 2
    assert f"already exists: {path}; give --commands" in capsys.readouterr().err
    assert path.read_text() == "mine"


def test_no_file_is_made_through_a_link_that_leads_nowhere(tmp_path, capsys):
    path = tmp_path / "mine"
    path.symlink_to(tmp_path / "elsewhere")
    assert main([*way(), "--commands", str(path)]) == 2
    assert f"already exists: {path}; give --commands" in capsys.readouterr().err
    assert not (tmp_path / "elsewhere").exists()


@pytest.mark.parametrize(("mode", "other"), [("w", os.O_RDONLY), ("r", os.O_RDWR)])
def test_a_pipe_that_may_be_waited_for_is_named(tmp_path, capsys, mode, other):
    os.mkfifo(pipe := tmp_path / "pipe")
    end = os.open(pipe, other | os.O_NONBLOCK)  # there is nothing to wait for
    try:
        with ExitStack() as files:
            _opened(files, str(pipe), mode, sys.stdout)
    finally:
        os.close(end)
    said = capsys.readouterr().err
    assert f"waiting for a program at the other end of {pipe}\n" in said


def test_what_takes_no_commands_is_named(capsys):
    assert main([*way(), "--poses", os.devnull, "--commands", "/dev/full"]) == 6
    said = "commands cannot be sent, No space left on device: t = 0.00 s; give"
    assert said in capsys.readouterr().err


@pytest.mark.physics
def test_a_pose_far_from_where_the_robot_can_be_is_refused(tmp_path, capsys):
    """A camera that counts millimetres, and one that names no time."""
    poses, exact = tmp_path / "poses.jsonl", way()[:8]  # a tag's outliers are left out
    line = '{{"time": {}, "x": 8.0, "y": 0.0, "yaw": 0.0}}\n'
    poses.write_text("".join(line.format(number / 10) for number in range(200)))
    assert main([*exact, "--poses", str(poses), "--commands", os.devnull]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert "the robot is told to be 8 m from where it should be: segment 1; " in said
    poses.write_text('{"x": 0.004, "y": 0.0, "yaw": 0.0}\n')
    assert main([*exact, "--poses", str(poses), "--commands", os.devnull]) == 2
    assert "not a pose, no time, or a number" in capsys.readouterr().err


@pytest.mark.parametrize("pace", ["1e-320", "1e300", "nan", "-1"])
def test_a_pace_that_no_clock_measures_is_refused(pace, capsys):
    assert main(["drive", "line", "--pace", pace]) == 2
    assert "is not a pace: --pace; give a number such as 1" in capsys.readouterr().err
