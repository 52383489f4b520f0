"""Commands that messages name can be pasted into a shell, whatever files are called."""

import os
import shlex
import shutil
import subprocess

import pytest

from models.description.robot import FOLDER
from sim.cli import main
from sim.endings import again, begin, command
from sim.scenarios.file import dumps, load_scenario
from sim.sweeps.file import read_sweep

EVIL = "a b$(touch PWNED);'c"


def two_runs(folder):
    for name in ("one", "two"):
        (folder / name).mkdir(parents=True)
        (folder / name / "summary.json").write_text("{}")


def a_shard(folder):
    folder.mkdir()
    (folder / "ledger-1-of-2.jsonl").touch()


def a_sweep(folder):
    folder.mkdir()
    (folder / "sweep.json").touch()


def no_card(folder):
    folder.mkdir()
    shutil.copy(FOLDER / "scene.xml", folder)
    text = (FOLDER / "hexapod.xml").read_text()
    (folder / "mine.xml").write_text(text.replace('model="hexapod"', 'model="other"'))


CASES = {
    "study of runs": (two_runs, ("study", EVIL), "compare", ("one", "two")),
    "study of a shard": (a_shard, ("study", EVIL), "merge", ("",)),
    "report of a sweep": (a_sweep, ("show", EVIL), "study", ("",)),
    "one folder": (two_runs, ("compare", EVIL), "compare", ("two", "one")),
    "no card": (no_card, ("robots", f"{EVIL}/mine.xml"), "adopt", ("mine.xml",)),
    "no log": (no_card, ("fit", f"{EVIL}/mine.xml"), "fit", ("mine.xml",)),
}


@pytest.mark.parametrize("case", CASES)
def test_a_shell_takes_the_command_in_a_message_as_it_is_meant(
    tmp_path, monkeypatch, capsys, case
):
    make, words, does, names = CASES[case]
    monkeypatch.chdir(tmp_path)
    make(tmp_path / EVIL)
    assert main(words) in (2, 3)
    advice = capsys.readouterr().err.rpartition("; ")[2].partition("stratawalk ")[2]
    verb, *rest = shlex.split(advice)
    assert verb == does
    wanted = [str(tmp_path / EVIL / name) for name in names]
    assert {str(tmp_path / word) for word in rest} >= {*wanted}


def test_a_folder_whose_name_begins_with_a_dash_is_no_option(tmp_path):
    assert command("show", (tmp_path / "-x").relative_to(tmp_path)).endswith(
        "show ./-x"
    )


@pytest.mark.physics
def test_a_name_that_no_file_may_have_is_refused_in_one_line(folder, tmp_path, capsys):
    words = ("export", str(folder), "--format", "csv", "--no-play", "--out")
    assert main((*words, str(tmp_path / ("x" * 300 + ".csv")))) == 6
    (line,) = capsys.readouterr().err.splitlines()
    assert "File name too long" in line
    assert "give another name" in line


def test_what_is_made_in_a_folder_needs_its_name(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for command_line in (("merge", "one", "two"), ("study", "one")):
        assert main((*command_line, "--out", "")) == 2
        assert "an empty name: --out" in capsys.readouterr().err
    assert not [*tmp_path.iterdir()]


def test_more_designs_than_can_be_counted_are_refused(capsys):
    assert main(("design", "hexapod", "--walks", "0", "--designs", str(10**20))) == 2
    assert "1000000" in capsys.readouterr().err


def test_a_command_again_keeps_words_that_are_like_the_values_of_others():
    begin(["run", "line", "--segments", "2", "--no-video", "--draw=1", "--tries", "4"])
    again_from = again("--draw", "2", "--tries", "2")
    begin(["sweep", "--out", "s", "--", "sw.toml"])
    behind = again("--resume")
    begin(["run", "line", "--set", "draw=3", "--set=draw=4", "--set", "friction=1"])
    settings = again("--draw", "7")
    begin([])
    assert settings == "stratawalk run line --set friction=1 --draw 7"
    assert behind == "stratawalk sweep --out s --resume -- sw.toml"
    assert again_from == (
        "stratawalk run line --segments 2 --no-video --draw 2 --tries 2"
    )


@pytest.mark.parametrize(
    ("words", "advice"),
    [
        (["play", "line", "line.csv"], "try stratawalk play hexapod line.csv"),
        (["friction", "$(it)"], "stratawalk run line --set 'friction=$(it)'"),
        (["run", "line", "--frction", "$(it)"], "write --set 'friction=$(it)'"),
        (["run", "my sweep.toml"], "stratawalk sweep 'my sweep.toml' --out 'sweeps/my"),
        (["run", "line", "--steps", "$(it)"], "write --segments VALUE"),
        (["run", "line", "--mass", "it's"], "write --set 'payload=[VALUE, 0, 0, 0]'"),
        (["run", "line", "--set", "friction", "`it`"], "--set 'friction=`it`'"),
        (["run", "--", "--speed"], "unknown scenario '--speed'"),
    ],
    ids=str,
)
def test_advice_changes_one_word_and_quotes_what_was_given(
    words, advice, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my sweep.toml").write_text('scenario = "line"')
    begin(words)
    assert main(words) == 2
    assert advice in capsys.readouterr().err


@pytest.mark.parametrize("run", [True, False])
@pytest.mark.parametrize(("key", "other"), [("robot", "octopod"), ("servo", "mg996r")])
def test_what_a_run_s_robot_gave_is_not_handed_to_another_without_a_word(
    run, key, other, tmp_path, capsys
):
    """The scenario of a run has the servos of its robot, and what was fitted to it."""
    file = tmp_path / "scenario.toml"
    file.write_text(dumps(load_scenario("line", {"path.goal": [0.004, 0, 0]})))
    if run:
        (tmp_path / "summary.json").touch()
    assert main(["plan", str(file), "--set", f"{key}={other}", "--segments=1"]) == 0
    said = f"{file} has all settings of a run, those that its robot gave as well"
    assert (said in capsys.readouterr().err) == run
    sweep = tmp_path / "sweep.toml"
    sweep.write_text(f'scenario = "scenario.toml"\n[grid]\n{key} = ["{other}"]\n')
    read_sweep(str(sweep))
    assert (said in capsys.readouterr().err) == run


def test_a_shell_takes_a_printed_command_and_no_terminal_obeys_it():
    words = ["x\x1b[31m", "a\nb", "it's", "\u202e", "\x9b2J", "na\xefve", "back\\"]
    line = command(*words)
    assert line.isprintable()
    script = f"stratawalk() {{ printf '%s\\0' \"$@\"; }}\n{line}"
    env = os.environ | {"LC_ALL": "C.UTF-8"}
    given = subprocess.run(["bash", "-c", script], env=env, stdout=subprocess.PIPE)
    assert given.stdout.decode().split("\0")[:-1] == words
