"""The command as a user meets it: what it prints, and how it ends."""

import json
import re
import shlex
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest

from planner.errors import PlannerError
from sim import cli
from sim.commands.declared import COMMANDS
from sim.errors import exit_code, one_line
from sim.scenarios.file import load_scenario, shipped_scenarios
from tests.commands import OUTSIDE, Begun, refusal, told

SHORT = ("run", "line", "--segments", "1", "--set", "path.goal=[0.005, 0.005, 0]")
"""A walk of one segment and a few seconds."""
QUICK = (*SHORT, "--set", 'predictions=["quasi_static"]')
"""The same without the predictions that take longer than it."""


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["gallop"], 2, "unknown command 'gallop': stratawalk; begin with "),
        (["run"], 2, "SCENARIO missing: stratawalk run; for example"),
        (["run", "line", "--sgments", "3"], 2, "did you mean '--segments'?"),
        (
            ["run", "line", "--segments", "many"],
            2,
            "'many' is not allowed: --segments; g",
        ),
        (["run", "line", "--out", "\udcff"], 2, "is no text in UTF-8: stratawalk; "),
        (["sweep", "a", "--out", "b", "--workers", "999"], 2, "number, 1 to 256"),
        (["run", "line", "--segments", "0"], 2, "segments = 0 is not allowed"),
        (["run", "lien"], 2, "unknown scenario 'lien': SCENARIO; did you mean 'line'?"),
        (["run", "a; b"], 2, "stratawalk scenarios line > 'a; b.toml'"),
        (["run", "gone.toml"], 2, "no such scenario file: gone.toml"),
        (["run", "line", "--fields", "papper"], 2, "give lifted or paper"),
        (["run", "line", "--look", "pretty"], 2, "'pretty' is not allowed"),
        (["run", "line", "--set", "fricton=1"], 2, "did you mean 'friction'?"),
        (["run", "line", "--set", "friction=-1"], 2, "give a number from 0 to 10"),
        (["run", "line", "--set", "timestep=0"], 2, "timestep = 0 is not allowed"),
        (["run", "line", "--robot", "x", "--set", "robot=y"], 2, "given twice: --set"),
        (["identify", "hexapod", "--set", "robot=y"], 2, "robot is given twice"),
        (["run", "line", *2 * ["--set", "friction=1"]], 2, "friction is given twice"),
        (["run", "line", "--out", ""], 2, "an empty name: --out; give a name"),
        (["play", "a", "b", "--out", ""], 2, "an empty name: --out; give a name"),
        (["calibrate", "hexapod", "--answers", ""], 2, "an empty name: --answers; g"),
        (["run", "line", "--robot", "centipede"], 2, "unknown robot: 'centipede'"),
        (["run", "line", "--robot", "gone.xml"], 2, "no such robot file"),
        (["run", "line", "--set", "geometry={a=1}"], 2, "geometry.a is unknown: geom"),
        (
            ["run", "line", "--no-video", "--out", "."],
            2,
            "already exists: .; give --out",
        ),
        (["run", "line", "--no-video", "--out", "/proc/run"], 6, "cannot make the run"),
        (["plan", "line", "--segments", "1"], 4, "would reach .* segments"),
    ],
)
def test_refusal_is_one_line_and_a_code(stratawalk, words, code, said):
    done = stratawalk(*words)
    assert done.returncode == code
    assert re.search(said, refusal(done))


def test_refused_command_leaves_no_folder(stratawalk, tmp_path):
    stratawalk("run", "line", "--robot", "centipede")
    stratawalk("run", "line", "--set", "friction=-1")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", ["<mujoco", "<mujoco/>", "\x00\x01"])
def test_unusable_robot_file_is_a_bad_model(stratawalk, tmp_path, text):
    (tmp_path / "mine.xml").write_text(text)
    done = stratawalk("run", "line", "--robot", "mine.xml")
    assert done.returncode == 3
    assert re.search(r"mine\.(xml|toml)", refusal(done))
    assert "XML_ERROR" not in refusal(done)


def test_json_gives_an_error_as_an_object_too(stratawalk):
    done = stratawalk("run", "lien", "--json")
    error = json.loads(done.stdout)["error"]
    assert (error["exit_code"], error["kind"]) == (2, "usage")
    assert done.stderr == f"stratawalk: error: {error['message']}\n"


def test_debug_shows_the_traceback(stratawalk):
    done = stratawalk("run", "lien", "--debug")
    assert done.returncode == 2
    assert "Traceback" in done.stderr
    assert done.stderr.splitlines()[-1].startswith("stratawalk: error: ")


def test_every_command_answers_help(capsys):
    for name in COMMANDS:
        assert cli.main([name, "--help"]) == 0
        out, err = capsys.readouterr()
        assert err == ""
        assert f"stratawalk {name}" in out


def test_version_is_that_of_the_package(stratawalk):
    done = stratawalk("--version")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"stratawalk {version('stratawalk')}\n"


def test_scenarios_lists_what_is_shipped(stratawalk):
    lines = stratawalk("scenarios").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(shipped_scenarios())


def test_printed_scenario_is_a_scenario(stratawalk, tmp_path):
    (tmp_path / "mine.toml").write_text(stratawalk("scenarios", "ellipse").stdout)
    assert load_scenario(str(tmp_path / "mine.toml")) == load_scenario("ellipse")


def test_robots_lists_what_is_shipped(stratawalk):
    listed = json.loads(stratawalk("robots", "--json").stdout)
    robots = {robot["name"]: robot for robot in listed}
    assert {"hexapod", "hexapod-parallel"} <= robots.keys()
    assert robots["hexapod"]["groups"] == {"1": [1, 4, 5], "2": [2, 3, 6]}


def test_plan_goes_nowhere_when_the_goal_is_here(stratawalk):
    done = stratawalk("plan", "line", "--set", "path.goal=[0, 0, 0]", "--json")
    facts = json.loads(done.stdout)
    assert facts["pose"] == [0, 0, 0]
    assert facts["contact_switches"] == 0


def test_a_whole_turn_ends_at_yaw_0(stratawalk):
    around = "path.goal=[0, 0, 6.283185307179586]"
    done = stratawalk("plan", "diagonal", "--replan", "--set", around, "--json")
    facts = json.loads(done.stdout)
    assert abs(facts["pose"][2]) < 1e-6
    assert facts["error"]["yaw"] < 1e-6


def test_finer_plans_end_nearer_the_goal(stratawalk):
    def missed(segments):
        done = stratawalk("plan", "line", "--segments", str(segments), "--json")
        return json.loads(done.stdout)["error"]["position"]

    assert missed(80) == pytest.approx(missed(40) / 2, rel=0.05)  # 1/n, next term 1/n^2


def test_replanned_kinematics_end_at_the_goal(stratawalk):
    short = ("plan", "diagonal", "--segments", "12", "--json")
    done = stratawalk(*short, "--replan")
    open_loop = json.loads(stratawalk(*short).stdout)
    position = json.loads(done.stdout)["error"]["position"]
    assert position < open_loop["error"]["position"] / 10


@pytest.mark.physics
def test_run_leaves_a_folder_and_says_where(stratawalk, tmp_path):
    """It says nothing else, even where libraries find no home to keep files in.

    Physics runs whatever MUJOCO_GL says, and so does a report without a film.
    """
    nowhere = dict.fromkeys(("HOME", "MPLCONFIGDIR"), "/proc/nowhere")
    done = stratawalk(
        *SHORT, "--no-video", MUJOCO_GL="banana", MPLBACKEND="none", **nowhere
    )
    assert told(done.stderr) == []
    assert done.returncode == 0
    folder = tmp_path / "runs" / "line-001"
    assert {"scenario.toml", "model.xml", "commands.npz", "trajectory.npz"} <= {
        path.name for path in folder.iterdir()
    }
    assert not (folder / "video.mp4").exists()
    starts = [line.split()[0] for line in done.stdout.splitlines() if line]
    assert starts[-13:] == [
        "goal", "ideal", "quasi-static", "identified", "compliant", "achieved",
        "switch", "terms", "margin:", "slip:", "while", "folder", "report",
    ]  # fmt: skip
    made = [line.split()[-1] for line in done.stdout.splitlines()[-2:]]
    assert made == ["runs/line-001", "runs/line-001/report.html"]


@pytest.mark.physics
def test_written_scenario_runs_again_to_the_same_numbers(stratawalk, tmp_path):
    """Which are all that --json prints."""

    def numbers(out, *words):
        done = stratawalk(*words, "--no-video", "--json", "--out", out)
        (off,) = told(done.stderr)  # the paper's fields are not this robot's
        assert "off its goal" in off
        summary = json.loads(done.stdout)
        assert summary == json.loads((tmp_path / out / "summary.json").read_text())
        del summary["timing"]
        return summary

    first = numbers("a", *QUICK, "--fields", "paper", "--set", "friction=0.7")
    assert numbers("b", "run", "a/scenario.toml") == first
    assert first["fields"] == "paper"


@pytest.mark.physics
def test_run_without_a_driver_warns_in_one_line_and_walks(tmp_path):
    process = Begun(QUICK, tmp_path, OUTSIDE | {"MUJOCO_GL": "disabled"})
    _, said = process.communicate()
    assert process.returncode == 0
    (line,) = told(said)
    assert line.startswith("stratawalk: warning: no film: ")
    assert (tmp_path / "runs" / "line-001" / "summary.json").exists()


def test_film_that_cannot_be_drawn_is_refused_before_the_walk(stratawalk, tmp_path):
    done = stratawalk(*SHORT, "--video", MUJOCO_GL="disabled")
    assert done.returncode == 5
    assert "MUJOCO_GL=disabled" in refusal(done)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.physics
@pytest.mark.parametrize(
    ("sent", "code"),
    [
        (signal.SIGINT, 130),
        (signal.SIGTERM, 143),
        (signal.SIGHUP, 129),
        (signal.SIGXCPU, 152),
    ],
)
def test_signal_ends_a_run_with_one_line_and_whole_files(tmp_path, sent, code):
    words = ("run", "line", "--segments", "400", "--no-video", "--out", "here")
    process = Begun(words, tmp_path)
    while not (tmp_path / "here" / "model.xml").exists():
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(sent)
    _, stderr = process.communicate(timeout=30)
    assert process.returncode == code
    (line,) = told(stderr)
    assert line.startswith("stratawalk: error: ")
    assert re.search("; here keeps .*model.xml.*; start again: ", line)
    assert line.endswith(f": stratawalk {' '.join(words)}-2")
    assert [p.name for p in (tmp_path / "here").iterdir() if ".part" in p.name] == []


def test_a_dropped_connection_does_not_end_a_command_after_nohup(tmp_path):
    program = (
        "import os, signal, sys, sim.start\n"
        "from sim.commands import systems\n"
        "list_them = systems.scenarios\n"
        "def scenarios(options):\n"
        "    os.kill(os.getpid(), signal.SIGHUP)\n"
        "    list_them(options)\n"
        "systems.scenarios = scenarios\n"
        "sys.argv = ['stratawalk', 'scenarios']\n"
        "sys.exit(sim.start.main())\n"
    )
    command = ["nohup", sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, env=OUTSIDE)
    assert (done.returncode, "corridor" in done.stdout) == (0, True)


def test_reader_that_leaves_is_no_error(tmp_path):
    words = f"{shlex.quote(sys.executable)} -m sim.cli scenarios"
    done = subprocess.run(
        ["sh", "-c", f"{words} | true"],
        env=OUTSIDE | {"PYTHONUNBUFFERED": "1"},
        capture_output=True,
        text=True,
    )
    assert done.stderr == ""


def test_error_of_the_planner_is_a_failed_plan():
    error = PlannerError("phi_1 would reach 9; plan more segments")
    assert exit_code(error) == 4
    assert one_line(error) == "no plan: phi_1 would reach 9; plan more segments"


def test_unforeseen_error_is_a_bug_of_ours_and_says_where(monkeypatch, capsys):
    monkeypatch.setattr("sim.scenarios.file.shipped_scenarios", lambda: 1 / 0)
    assert cli.main(["scenarios"]) == 70
    said = capsys.readouterr().err
    assert "a bug of ours, ZeroDivisionError: division by zero: " in said
    assert f"{Path('sim', 'commands', 'systems.py')}:" in said


def test_a_closed_standard_input_is_an_empty_one(tmp_path):
    (tmp_path / "new").mkdir()
    (tmp_path / "new" / "joint-12.png").touch()  # all joints are drawn already
    asked = f"{sys.executable} -m sim.start calibrate hexapod --out new <&-"
    done = subprocess.run(asked, shell=True, cwd=tmp_path, capture_output=True)
    assert done.returncode == 2
    assert b"answers end: standard input" in done.stderr
