"""The code and the commands of README and docs run, and print what is shown there."""

import re
import shutil
from itertools import pairwise

import pytest

from sim.cli import main
from tests.pages import blocks, commands

SHORTER = {  # a path of 14 mm, and a film in which a minute takes a second
    "(0.15, 0.15, 0)": "(0.01, 0, 0)",  # as on a page, so that it is computed once
    "segments=40": "segments=2",
    "sim.walk(robot, plan)": "sim.walk(robot, plan, playback=60.0)",
}
LONG = ("run", "film", "figures", "bench", "sensitivities", "fit")  # up to minutes each
LONGEST = {  # which others stand for among the quick tests, in the same words
    ("plan", "biped", "--optimise", "strokes"),  # as with --free theta
    ("doctor",),  # as in tests/sim/commands/test_doctor.py
}
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]\d+)?")
TIME = re.compile(r"(?<=in )[\d.]+ s\b|[\d.]+ ms\b")  # on this machine
CLOSE = 0.02  # of a number shown; other processors round differently


def python_blocks():
    return [block for block in blocks("python") if block.page != "README.md"]


def command_lines():
    """Every command line once, with all that pages show under it."""
    shown = {}
    for command in commands():
        shown.setdefault(command.words, []).extend(
            [command.shown] * bool(command.shown)
        )
    return [
        pytest.param(
            words,
            pages,
            id=" ".join(words),
            marks=[pytest.mark.full] * (words[0] in LONG or words in LONGEST),
        )
        for words, pages in shown.items()
    ]


@pytest.mark.physics
@pytest.mark.parametrize("block", python_blocks(), ids=str)
def test_every_python_block_runs_and_prints_what_is_shown(
    block, folder, monkeypatch, capsys
):
    """Those that read files do so in a run folder."""
    monkeypatch.chdir(folder)
    exec(compile(block.text, block.page, "exec"), {})
    if block.shown:
        assert agrees(block.shown, capsys.readouterr().out)


@pytest.mark.physics
@pytest.mark.render
@pytest.mark.usefixtures("driver")
def test_the_library_example_of_the_readme_runs(tmp_path, monkeypatch):
    (text,) = (block.text for block in blocks("python") if block.page == "README.md")
    for long, short in SHORTER.items():
        assert text.count(long) == 1
        text = text.replace(long, short)
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(text, "README.md", "exec"), names)
    assert (tmp_path / "line.mp4").stat().st_size > 0
    off = names["report"].summary["error"]["quasi_static"]["position_per_path"]
    assert off < 0.01  # 0.004 measured


def agrees(shown, printed):
    """Whether the words are the same and the numbers nearly so, times aside."""
    shown, printed = (TIME.sub("T", text).split() for text in (shown, printed))
    if [NUMBER.sub("#", w) for w in shown] != [NUMBER.sub("#", w) for w in printed]:
        return False
    numbers, others = (
        [float(n) for n in NUMBER.findall(" ".join(words))]
        for words in (shown, printed)
    )
    return others == pytest.approx(numbers, rel=CLOSE, abs=1e-4)


@pytest.mark.physics
@pytest.mark.parametrize(("words", "pages"), command_lines())
def test_every_command_prints_what_is_shown(
    words, pages, walked, tmp_path, monkeypatch, capsys, request
):
    if any("report.html" in line for shown in pages for line in shown):
        request.getfixturevalue("paged")
    if "--peers" in words:
        pytest.importorskip("casadi")
    monkeypatch.chdir(tmp_path)
    for before, word in pairwise(words):  # runs that are named have been made
        if re.fullmatch(r"runs/[\w-]+", word) and before != "--out":
            shutil.copytree(walked, tmp_path / word)
    assert main(list(words)) == 0
    printed = capsys.readouterr().out
    assert printed
    for shown in pages:
        assert agrees("\n".join(shown), printed)


@pytest.mark.full
@pytest.mark.physics
def test_the_walk_of_the_readme_ends_as_shown(paged, tmp_path, monkeypatch, capsys):
    own = (block.text for block in blocks("text") if block.page == "README.md")
    (shown,) = (text for text in own if "achieved" in text)
    monkeypatch.chdir(tmp_path)
    assert main(["run", "line", "--no-video"]) == 0
    film = "film         runs/line-001/video.mp4"
    assert agrees(shown.replace(film, ""), capsys.readouterr().out)


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("walked 1.25 m in 17.3 s", "walked 1.26 m in 4.0 s", True),
        ("walked 1.25 m in 17.3 s", "walked 1.35 m in 17.3 s", False),
        ("walked 1.25 m", "walked 1.25 mm", False),
        ("x -0.46", "x 0.46", False),
        ("S12 -> S1", "S12 -> S2", False),
    ],
)
def test_what_is_shown_agrees_up_to_times_and_rounding(shown, printed, same):
    assert agrees(shown, printed) is same
