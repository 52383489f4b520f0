"""The page of the first robot: its commands run one after another, as shown."""

import shlex
from types import SimpleNamespace

import pytest

from models import Kinematics, load
from sim.cli import main
from tests.docs.test_code import agrees
from tests.pages import PROMPT, ROOT, blocks
from tests.sim.export.test_calibration import Board

PAGE = "docs/first-robot.md"


def sessions():
    """Commands of the page and what is shown under each."""
    for block in blocks("text"):
        if block.page == PAGE:
            command, _, shown = block.text.partition("\n")
            yield shlex.split(command.removeprefix(PROMPT)), shown


@pytest.fixture
def told(monkeypatch):
    """An owner whose answers are seen, as on a terminal."""
    answer = Board(1).owner()

    def owner(question):
        told = answer(question)
        print(question + told)
        return told

    monkeypatch.setattr("sys.stdin", SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr("builtins.input", owner)


def begun(words, shown, capsys):
    assert main(words) == 0
    printed = capsys.readouterr().out
    first, gap, last = shown.partition("...\n")
    if gap:
        assert printed.startswith(first)
        assert printed.endswith(last)
    else:
        assert not shown or agrees(shown, printed)


@pytest.mark.usefixtures("told")
def test_calibrating_prints_what_is_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)
    for words, shown in sessions():
        if words[0] in ("calibrate", "robots"):
            begun(words, shown, capsys)


@pytest.mark.full
@pytest.mark.physics
@pytest.mark.usefixtures("told", "paged")
def test_the_whole_way_is_walked_as_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)
    for words, shown in sessions():
        begun(words, shown, capsys)


def test_the_table_of_hips_and_feet_is_the_robot_s():
    robot = load("hexapod-classroom")
    kinematics = Kinematics(robot)
    rows = [
        line.strip("|").split("|")
        for line in (ROOT / PAGE).read_text().splitlines()
        if line.startswith(tuple(f"| {leg} | " for leg in robot.legs))
    ]
    rows = [row for row in rows if len(row) == 4 and "," in row[1]]
    for (_, hip, foot, _), leg, stands in zip(
        rows, robot.leg_cards, kinematics.standing.feet, strict=True
    ):
        anchor = kinematics.hinge(leg.swing)[1][:2]
        for shown, place in ((hip, anchor), (foot, stands)):
            millimetres = [float(number) for number in shown.split(",")]
            assert millimetres == pytest.approx(1e3 * place, abs=0.06)
