"""Commands that the pages show as text, because they need files or go on, run too."""

import contextlib
import os
import re
import shlex
import shutil
import signal
import subprocess

import pytest

from scripts.adoptees import ADOPTEES
from sim.cli import main
from sim.sweeps.file import read_sweep
from tests.commands import COMMAND, OUTSIDE, run, told
from tests.docs.test_code import agrees
from tests.pages import PROMPT, blocks
from tests.sweeps import walked_here, write_sweep

VARIES = "[grid]\nfriction = [0.5, 1.0]\n"
LONG = ("design", "friction-speed")  # half a minute and more
ELSEWHERE = (
    "--scheduler",
)  # with a real cluster, in tests/sim/sweeps/test_worker_pool.py


def lines():
    """Every `$ stratawalk ...` in a block of text."""
    return [
        line.removeprefix(PROMPT)
        for block in blocks("text")
        if block.page != "docs/first-robot.md"  # in test_first_robot.py
        for line in block.text.splitlines()
        if line.startswith(PROMPT) and not any(word in line for word in ELSEWHERE)
    ]


def words_of(line):
    return shlex.split(os.path.expandvars(line), comments=True)


def shown_under(command):
    (text,) = (b.text for b in blocks("text") if f"{PROMPT}{command}\n" in b.text)
    return text.partition(f"{PROMPT}{command}\n")[2]


def some(*commands):
    """The lines that begin with one of the commands, each of them once."""
    return [
        pytest.param(line, marks=[pytest.mark.full] * any(w in line for w in LONG))
        for line in dict.fromkeys(lines())
        if line.startswith(commands)
    ]


def test_every_command_shown_as_text_is_run_below():
    ran = some("sweep", "merge", "study", "design", "view", "adopt")
    assert len(ran) == len(set(lines())) > 10


def printed(words, folder):
    """What a command prints that must end with 0, in a process of its own."""
    done = run(words, folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="session")
def swept(tmp_path_factory):
    """A folder with a small sweep, `friction.toml`, and what it came to."""
    folder = tmp_path_factory.mktemp("swept")
    write_sweep(folder, VARIES, name="friction")
    sweep = "sweep friction.toml --out sweeps/friction --workers 1"
    with contextlib.chdir(folder):
        assert walked_here(*sweep.split()).returncode == 0
    return folder


@pytest.mark.physics
@pytest.mark.parametrize("line", some("sweep", "merge", "study", "design"))
def test_commands_of_sweeps_run(line, swept, tmp_path, monkeypatch):
    monkeypatch.setenv("SLURM_ARRAY_TASK_ID", "1")
    shutil.copy(swept / "friction.toml", tmp_path)
    words = words_of(line)
    if words[0] in ("merge", "study") or "--resume" in words:
        shutil.copytree(swept / "sweeps", tmp_path / "sweeps")
    if line == "study sweeps/friction-speed":
        printed(["sweep", "friction-speed", "--out", "sweeps/friction-speed"], tmp_path)
        assert agrees(shown_under(line), printed(words, tmp_path))
    elif line.startswith("sweep friction-speed"):
        pass  # just above
    else:
        monkeypatch.chdir(tmp_path)
        done = walked_here(*words)
        assert (done.returncode, told(done.stderr)) == (0, [])
        assert done.stdout


@pytest.mark.physics
def test_the_table_of_a_sweep_is_read_as_shown(swept, monkeypatch):
    (block,) = (b.text for b in blocks("text") if b.text.startswith("import pandas"))
    monkeypatch.chdir(swept)
    names = {}
    exec(compile(block, "sweeps.md", "exec"), names)
    assert len(names["rows"]) == 2
    assert len(names["held"]) <= 2


@pytest.mark.parametrize(
    ("has", "points"), [("[sobol]", 9 * 2 * 3 * 64), ("stiffness = [150, 450]", 10)]
)
def test_the_sweep_shown_is_one(tmp_path, has, points):
    (block,) = (b.text for b in blocks("toml") if has in b.text)
    (tmp_path / "friction.toml").write_text(block)
    assert len(read_sweep(str(tmp_path / "friction.toml"))) == points


@pytest.mark.physics
def test_the_robot_that_is_adopted_prints_what_is_shown(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (line,) = (words_of(line) for line in lines() if line.startswith("adopt"))
    (robot,) = (a for a in ADOPTEES if line[1] == a.write(tmp_path).name)
    assert main(line) == 0
    shown = shown_under(" ".join(line)).splitlines()
    assert agrees(
        "\n".join(shown), "\n".join(capsys.readouterr().out.splitlines()[-len(shown) :])
    )


def usual(line):
    """A line of the viewer with one port and one token, which are new each time."""
    line = re.sub(r"(?<=token=)[\w-]{22}$", "TOKEN", line)
    return re.sub(r"\b\d{4,5}\b", "8080", line)


@pytest.mark.physics
def test_the_viewer_says_what_is_shown_until_it_is_interrupted(walked, tmp_path):
    (line,) = (line for line in lines() if line.startswith("view"))
    shutil.copytree(walked, tmp_path / words_of(line)[1])
    process = subprocess.Popen(
        [*COMMAND, *words_of(line)],
        cwd=tmp_path, env=OUTSIDE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    shown = shown_under(line).splitlines()
    try:
        said = [process.stdout.readline().rstrip("\n") for _ in shown]
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.stdout.close()
    assert [usual(line) for line in said] == [usual(line) for line in shown]
