"""Inputs and surroundings that once ended the command with a traceback."""

import os
import signal
import subprocess
import sys
import time

import psutil
import pytest

from sim.cli import main
from tests.commands import COMMAND, OUTSIDE, refusal

SYSTEM = """
state = ["a", "b", "c"]
goal = { c = 1 }
start = { a = 1, b = 1 }
[strata.0]
f = { a = 1, c = "%s" }
g = { b = 1 }
"""


@pytest.mark.parametrize("formula", ["Abs(b)", "b*sign(a)"])
def test_documented_functions_with_kinks_can_be_planned_with(
    stratawalk, tmp_path, formula
):
    (tmp_path / "kink.toml").write_text(SYSTEM % formula)
    done = stratawalk("check", "kink.toml")
    assert (done.returncode, done.stderr) == (0, "")


TOML = {
    "nested deeply": "segments = " + "[" * 5000,
    "nested too deeply": f"segments = {'[' * 40}1{']' * 40}",
    "of many digits": "segments = " + "1" * 5000,
    "beyond every float": f"friction = 1{'0' * 400}",
}


@pytest.mark.parametrize("text", TOML.values(), ids=TOML)
def test_toml_that_python_cannot_hold_is_bad_configuration(stratawalk, tmp_path, text):
    for name, words in (("mine.toml", ("plan", "mine.toml")), ("s.toml", ("check",))):
        (tmp_path / name).write_text(text)
        done = stratawalk(*words, *([name] if len(words) == 1 else []))
        assert done.returncode == 2
        assert name in refusal(done)


def test_a_number_of_an_option_may_be_too_large_for_python(stratawalk):
    done = stratawalk("plan", "line", "--set", f"friction=1{'0' * 400}")
    assert done.returncode == 2
    assert "friction = '1000" in refusal(done)


def test_a_timestep_that_no_walk_would_survive_is_refused(stratawalk):
    done = stratawalk("plan", "line", "--set", "timestep=1e-320")
    assert done.returncode == 2
    assert "give a number from 1e-06 to 0.02" in refusal(done)


def test_an_engine_without_room_is_a_bad_model(stratawalk, robot):
    done = stratawalk("robots", robot("<worldbody>", '<size memory="20K"/><worldbody>'))
    assert done.returncode == 3
    assert "MuJoCo cannot run the model: " in refusal(done)


def test_a_gain_that_overflows_is_a_bad_card(stratawalk, robot):
    done = stratawalk("robots", robot("{ 1 = -1,", "{ 1 = 1e308,"))
    assert done.returncode == 3
    assert "none beyond 1e+12 is taken" in refusal(done)


def test_mjcf_in_latin_1_is_read(stratawalk, robot):
    name = robot("<worldbody>", "<!-- Fü\xdfe --><worldbody>", encoding="latin-1")
    done = stratawalk("robots", name)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_working_folder_that_is_gone_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    tmp_path.rmdir()
    assert main(["run", "line"]) == 6
    assert "the working folder; check" in capsys.readouterr().err


def test_what_ascii_cannot_say_is_said_in_escapes(stratawalk):
    done = stratawalk("robots", "ö", PYTHONIOENCODING="ascii")
    assert done.returncode == 2
    assert r"unknown robot: '\xf6'" in refusal(done)


@pytest.mark.parametrize("words", [("plan", "biped"), ("plan", "gone")], ids=" ".join)
def test_a_full_disk_under_the_output_is_a_fault_of_files(stratawalk, words):
    with open("/dev/full", "w") as full:
        done = stratawalk(*words, "--json", stdout=full)
    assert done.returncode == (6 if words[1] == "biped" else 2)
    said = "No space left on device: standard output; free some space; written files "
    said += "are complete; start again: stratawalk plan biped --json"
    assert (refusal(done) == said) == (words[1] == "biped")


def test_help_that_a_full_disk_does_not_take_is_lost_with_a_word(stratawalk):
    with open("/dev/full", "w") as full:
        done = stratawalk("help", "run", stdout=full)
    assert done.returncode == 6
    assert refusal(done).startswith("No space left on device: standard output; ")


def test_what_is_written_need_not_be_started_again(stratawalk, folder, tmp_path):
    """A full disk takes its words alone."""
    to = ["--format", "csv", "--no-play", "--out", str(tmp_path / "walk.csv")]
    with open("/dev/full", "w") as full:
        done = stratawalk("export", str(folder), *to, stdout=full)
    assert done.returncode == 6
    assert done.stderr.endswith("; only what it prints is lost\n")
    assert "start again" not in done.stderr


def test_a_full_disk_under_standard_error_leaves_the_code(stratawalk):
    with open("/dev/full", "w") as full:
        done = stratawalk("plan", "gone", stderr=full, PYTHONUNBUFFERED="")
    assert (done.returncode, done.stdout) == (2, "")


def test_a_notice_that_cannot_be_said_ends_no_walk(stratawalk, tmp_path):
    small = ["--segments", "1", "--set", "path.goal=[0.005,0,0]", "--no-video"]
    with open("/dev/full", "w") as full:
        words = ["run", "line", *small, "--set", "slope=[0.01,0]", "--out", "walk"]
        done = stratawalk(*words, stderr=full)
    assert done.returncode == 0
    assert (tmp_path / "walk" / "summary.json").is_file()


PYTHON = {
    "sys.exit": "import sys; sys.exit(0)",
    "an exception of its own": "class Gone(BaseException): pass\nraise Gone",
    "a plain error": "1 / 0",
}


@pytest.mark.parametrize("text", PYTHON.values(), ids=PYTHON)
def test_a_python_system_may_end_as_it_likes(stratawalk, tmp_path, text):
    (tmp_path / "mine.py").write_text(text)
    done = stratawalk("check", "mine.py")
    assert done.returncode == 2
    assert "bad system: mine.py; it ends with " in refusal(done)


FUNCTION = """
import sys
import sympy as sp
from models import Problem
from planner import StratifiedSystem

calls = []

def f(x):
    calls.append(x)
    if len(calls) > 400:
        sys.exit(0)
    return [1, 0, x[1]]

system = StratifiedSystem(sp.symbols("x y z"), {"0": {"f": f, "g": [0, 1, 0]}}, "0")
problem = Problem(
    name="mine", description="", system=system, gait=("0",), goal={"x": 1},
    elements=("f", "g", "[f,g]"),
)
"""


def test_a_function_of_a_field_may_end_as_it_likes(stratawalk, tmp_path):
    (tmp_path / "mine.py").write_text(FUNCTION)
    done = stratawalk("plan", "mine.py")
    assert done.returncode == 4
    assert "a field's function ends with SystemExit at (" in refusal(done)


def test_a_plan_is_never_saved_over_another(stratawalk, tmp_path):
    (tmp_path / "plan.json").write_text("mine")
    done = stratawalk("plan", "biped", "--save", "plan.json")
    assert done.returncode == 2
    assert "already exists: plan.json; give --save another name" in refusal(done)
    assert (tmp_path / "plan.json").read_text() == "mine"


@pytest.mark.parametrize(
    ("number", "code"),
    [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)],
)
def test_a_signal_while_the_command_loads_is_one_line(tmp_path, number, code):
    """Sent as soon as our first module runs, long before all of it is loaded."""
    program = (
        "import os, signal, sys, importlib.abc\n"
        "import sim.start\n"
        "class Trap(importlib.abc.MetaPathFinder):\n"
        "    def find_spec(self, name, path, target=None):\n"
        f"        if name == 'sim.cli': os.kill(os.getpid(), {int(number)})\n"
        "sys.meta_path.insert(0, Trap())\n"
        "sys.argv = ['stratawalk', 'robots']\n"
        "sys.exit(sim.start.main())\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=OUTSIDE
    )
    assert (done.returncode, done.stdout) == (code, "")
    assert refusal(done).endswith("nothing was begun; start again: stratawalk robots")


def test_a_library_that_was_stopped_halfway_says_nothing_more(stratawalk, tmp_path):
    (tmp_path / "mine.py").write_text(
        "import atexit, os, signal\n"
        "atexit.register(lambda: 1 / 0)\n"
        "os.kill(os.getpid(), signal.SIGINT)\n"
    )
    done = stratawalk("check", "mine.py")
    assert done.returncode == 130
    assert refusal(done).startswith("interrupted: Ctrl-C")


def test_hints_to_programmers_reach_nobody_else(stratawalk, tmp_path):
    """Neither from the command's own process nor from one that it begins."""
    (tmp_path / "mine.py").write_text(
        "import subprocess, sys, warnings\n"
        "hint = 'import warnings; warnings.warn(\"mind\")'\n"
        "exec(hint)\n"
        "subprocess.run([sys.executable, '-c', hint])\n"
        "raise SystemExit('done')\n"
    )
    done = stratawalk("check", "mine.py")
    assert done.returncode == 2
    assert "SystemExit: done" in refusal(done)


def test_ctrl_c_is_answered_while_a_users_model_compiles(robot, tmp_path):
    name = robot(
        "<worldbody>",
        '<worldbody><replicate count="300000"><geom size="1"/></replicate>',
    )
    process = subprocess.Popen(
        [*COMMAND, "robots", name],
        cwd=tmp_path,
        env=OUTSIDE,
        stderr=subprocess.PIPE,
        text=True,
    )
    command = psutil.Process(process.pid)
    while not (tried := command.children()) or tried[0].cpu_times().user < 1.0:
        time.sleep(0.05)  # until it has loaded the engine and is compiling
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=20)
    assert process.returncode == 130
    assert said.startswith("stratawalk: error: interrupted")


@pytest.mark.parametrize(
    "words", [[5], ["run", None], ["compare", "a", "--out", "a\0b"], ["plan", b"line"]]
)
def test_words_of_a_program_that_no_shell_has_are_refused(words, capsys):
    assert main(words) == 2
    assert "is no text in UTF-8: stratawalk; rename it" in capsys.readouterr().err


def test_what_the_environment_tells_sympy_is_not_asked(monkeypatch):
    """It ended with "a bug of ours", since SymPy evaluates it."""
    told = os.environ | {"SYMPY_CACHE_SIZE": "abc", "SYMPY_DEBUG": "abc"}
    done = subprocess.run([*COMMAND, "plan", "biped"], env=told, capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")


SPAWNING = """
import sys
from multiprocessing import get_context
from sim import cli, start
def walked():
    child = get_context("spawn").Process(target=print, args=("it ran",))
    child.start()
    child.join()
    return child.exitcode
if __name__ == "__main__":
    cli.main = walked
    sys.exit(start.main())
"""


def test_processes_take_no_modules_of_the_working_folder(tmp_path):
    """Whose names may be those of Python's own."""
    (tmp_path / "multiprocessing.py").write_text("raise SystemExit('a stranger ran')")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "start.py").write_text(SPAWNING)
    done = subprocess.run(
        [sys.executable, "bin/start.py"],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": os.getcwd()},
        capture_output=True, text=True,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "it ran\n", "")
