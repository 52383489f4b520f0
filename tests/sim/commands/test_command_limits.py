"""How often, how far and how much commands take before they say that it is too much."""

import argparse
import builtins
import io
import sys
from types import SimpleNamespace

import pytest

from models import JointServo
from models.description import KNOWN_SERVOS
from sim.commands import doctor, options
from sim.commands.calibrate import BOARD_CHANNELS, _Asker, _calibrated, _clock
from sim.commands.drive import Poses
from sim.endings import begin
from sim.errors import FilesError, UsageError, one_line
from sim.folder import RunFolder
from sim.scenarios.file import load_scenario


@pytest.fixture(autouse=True)
def begun():
    """Forget what work of other tests has kept."""
    begin([])


def test_a_question_is_asked_a_hundred_times_at_most(monkeypatch):
    asked = []

    def never(text):
        asked.append(text)
        raise ValueError("no")

    monkeypatch.setattr(builtins, "input", lambda question: "?")
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: True))
    with pytest.raises(UsageError, match="100 answers to one question"):
        _Asker(None)("which? ", never)
    assert len(asked) == 100


def test_an_answer_of_a_file_that_cannot_be_used_ends_all(tmp_path):
    """What follows it would be answers to other questions."""
    file = tmp_path / "answers"
    file.write_text("swing_9\nswing_1\n")
    ask = _Asker(str(file))
    said = f"cannot be used, invalid literal.*: {file}; written files"
    with pytest.raises(UsageError, match=said):
        ask("which? ", int)


@pytest.mark.parametrize(("text", "clock"), [("", None), ("25", 25e6), ("30", 30e6)])
def test_clocks_are_told_in_megahertz(text, clock):
    assert _clock(lambda question, read: read(text)) == clock


def test_a_board_has_sixteen_channels():
    assert (BOARD_CHANNELS[0], BOARD_CHANNELS[-1]) == (0, 15)
    assert len(BOARD_CHANNELS) == 16


@pytest.mark.parametrize(("goal", "told"), [(4.9, False), (5.1, True)])
def test_goals_farther_than_five_metres_may_be_meant_in_millimetres(
    goal, told, monkeypatch
):
    said = []
    scenario = load_scenario("line", {"path.goal": [goal, 0.0, 0.0]})
    monkeypatch.setattr(options, "notice", said.append)
    monkeypatch.setattr(options, "settings_of", lambda _: {})
    monkeypatch.setattr(options, "given_settings", lambda _: {})
    monkeypatch.setattr("sim.scenarios.file.load_scenario", lambda *_: scenario)
    options.scenario_of(argparse.Namespace(scenario="line"))
    assert bool(said) == told


def test_ten_thousand_poses_wait_and_the_oldest_go(monkeypatch):
    line = '{{"time": {}, "x": 0, "y": 0, "yaw": 0}}\n'
    monkeypatch.setattr("sim.commands.drive.Thread", lambda **_: SimpleNamespace(
        start=lambda: None, daemon=True
    ))  # fmt: skip
    poses = Poses(io.StringIO())
    poses._listen(io.StringIO("".join(line.format(k) for k in range(10_003))))
    assert poses._queue.qsize() == 10_001  # and the end of what is sent
    assert poses.next(1.0)[0] == 3.0


@pytest.mark.parametrize(("spaces", "read"), [(9_900, True), (10_001, False)])
def test_a_line_of_a_pose_has_ten_thousand_letters_at_most(spaces, read):
    line = '{"time": 1, "x": 0, "y": 0, "yaw": 0' + " " * spaces + "}\n"
    poses = Poses(io.StringIO(line))
    if read:
        assert poses.next(1.0)[0] == 1.0
    else:
        with pytest.raises(UsageError, match="not a pose"):
            poses.next(1.0)


@pytest.mark.parametrize(("count", "more"), [(3, ""), (4, ", and 1 more")])
def test_three_packages_that_differ_are_named(count, more, monkeypatch):
    differ = [(f"p{k}==1", f"p{k} is old") for k in range(count)]
    monkeypatch.setattr(doctor, "differences", lambda: iter(differ))
    with pytest.raises(FilesError, match=f"^p0 is old, p1 is old, p2 is old{more}:"):
        doctor._packages()


def test_more_servos_than_a_board_has_channels_are_refused_at_once(tmp_path, hexapod):
    """Those that are known have theirs, too."""
    joints = [f"joint_{number}" for number in range(18)]
    of_legs = dict(zip(joints[:4], hexapod.card.joints, strict=False))
    card = SimpleNamespace(
        joints=joints,
        mounted={joint: JointServo(channel=n) for n, joint in enumerate(of_legs)},
        board_clock=25e6,
    )
    robot = SimpleNamespace(
        card=card, path=tmp_path / "mine.xml", card_text=hexapod.card_text
    )
    said = (
        "14 servos are to be found on 12 free channels of a board: .*mine.toml; write"
    )
    with pytest.raises(UsageError, match=said):
        _calibrated(robot, KNOWN_SERVOS["pulse"], RunFolder(tmp_path), pytest.fail)


def test_an_answer_of_a_pipe_that_cannot_be_used_ends_all(monkeypatch):
    """As in a file; nobody is there to be asked again."""
    monkeypatch.setattr(sys, "stdin", io.StringIO("x\n3\n"))
    with pytest.raises(UsageError, match="cannot be used, .*: standard input; written"):
        _Asker(None)("which? ", int)


def test_an_answer_of_a_pipe_without_end_is_not_held(monkeypatch):
    endless = SimpleNamespace(isatty=lambda: False, readline=lambda size: "z" * size)
    monkeypatch.setattr(sys, "stdin", endless)
    with pytest.raises(UsageError, match="cannot be used, .* 'zzz"):
        _Asker(None)("which? ", int)


def test_answers_of_a_file_that_end_are_not_to_be_given_again(tmp_path):
    file = tmp_path / "answers"
    file.write_text("3\n")
    ask = _Asker(str(file))
    assert ask("which? ", int) == 3
    with pytest.raises(UsageError, match=f"answers end: {file}; written files"):
        ask("which? ", int)


def test_a_mistake_in_a_file_is_told_in_plain_characters(tmp_path):
    file = tmp_path / "answers"
    file.write_text("\x1b[31m\n")
    with pytest.raises(UsageError) as refusal:
        _Asker(str(file))("which? ", int)
    assert r"\x1b[31m" in one_line(refusal.value)
    assert "\x1b" not in one_line(refusal.value)
