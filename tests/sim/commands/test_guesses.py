"""The command as people guess it, before they have read anything."""

import os
import re
import shutil
from contextlib import suppress
from pathlib import Path

import pytest

from sim.cli import main
from sim.commands.declared import COMMANDS, GUESSES
from sim.commands.parsing import parser
from tests.finished_runs import sealed


@pytest.mark.parametrize("words", [[], ["help"], ["--help"], ["-h"]], ids=" ".join)
def test_asking_for_nothing_or_help_lists_the_commands(words, capsys):
    assert main(words) == 0
    said = capsys.readouterr()
    listed = re.findall(r"^    (\w+)\b", said.out, re.MULTILINE)
    assert listed == list(COMMANDS)
    assert said.err == ""


@pytest.mark.parametrize("command", COMMANDS)
def test_help_with_a_command_explains_it(command, capsys):
    assert main(["help", command]) == 0
    asked = capsys.readouterr().out
    assert main([command, "--help"]) == 0
    assert capsys.readouterr().out == asked


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (
            ["rnu", "line"],
            "unknown command 'rnu': stratawalk; did you mean stratawalk run l",
        ),
        (
            ["hlep"],
            "unknown command 'hlep': stratawalk; did you mean stratawalk help?",
        ),
        (
            ["help", "rum"],
            "unknown command 'rum': stratawalk; did you mean stratawalk run ",
        ),
        (["--verson"], "unknown option --verson: stratawalk; did you mean '--version'"),
        (
            ["plan", "line", "--robt=x"],
            "unknown option --robt: stratawalk plan; did you mean '--robot'",
        ),
        (
            ["figures", "--only", "lin"],
            "'lin' is not allowed: --only; did you mean 'line'? there are mechanism",
        ),
        (["completion", "bsh"], "'bsh' is not allowed: SHELL; did you mean 'bash'"),
        (["film", "gone"], "no such run folder: "),
        (["view", "gone"], "no such run folder: gone; give the folder of a finished"),
        (
            ["figures", "--only", "bracket"],
            "'bracket' is not allowed: --only; did you mean 'panels'",
        ),
        (
            ["run", "line", "--set", "path.goal=[0,", "0.05,", "0]"],
            "path.goal=[0, is not closed: --set; put quotes around a list",
        ),
        (["--"], "unknown option --: stratawalk; stratawalk --help lists all opt"),
    ],
    ids=str,
)
def test_a_slip_of_the_finger_is_answered_with_what_was_meant(words, meant, capsys):
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"stratawalk: error: {meant}")


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        ("run line --friction 0.5", "write --set friction=0.5"),
        ("run line --servo=mg996r", "write --set servo=mg996r"),
        ("plan line --swing-speed 1", "write --set swing_speed=1"),
        ("list", "stratawalk robots, stratawalk systems or stratawalk scenarios"),
        ("walk line", "try stratawalk run line"),
        ("simulate", "try stratawalk run line"),
        ("demo", "try stratawalk run line"),
        ("render", "try stratawalk film"),
        ("report", "try stratawalk show"),
        ("import robot.urdf", "try stratawalk adopt ROBOT.urdf"),
        ("install", "try stratawalk doctor"),
        ("systems unicycl", "did you mean 'unicycle'?"),
        ("show", "no run here: runs; walk one: stratawalk run line"),
        ("view", "no run here: runs; walk one: stratawalk run line"),
        ("film runs", "no run here: runs; walk one: stratawalk run line"),
        ("run line --set path.goal=0.1,0,0", "such as [0.1, 0, 0]"),
        ("run line --set mu=1", "did you mean 'friction'?"),
        ("sweep mu.toml --out x", "did you mean 'friction'?"),
        ("sweep top.toml --out x", "write it under [grid] where it varies"),
        ("run line --goal x=0.1", "write --set 'path.goal=[0.1, 0, 0]'"),
        ("compare fric fric", "a sweep and no run: fric; stratawalk study fric"),
        ("study friction-speed", "sweep it first: stratawalk sweep friction-speed"),
        ("show line-001", "no such run folder: line-001; did you mean runs/line-001?"),
        ("run line --robot mybot", "did you mean 'mybot.xml'?"),
        ("adopt hexapod", "walk it: stratawalk run line --robot hexapod"),
        ("run unicycle", "try stratawalk plan unicycle"),
        ("run sideways", "try stratawalk run line --set 'path.goal=[0, 0.05, 0]'"),
        (
            "help brackets",
            "try stratawalk plan unicycle, or stratawalk figures --only p",
        ),
        ("robots mybot.xml", "draft one: stratawalk adopt"),
        ("teach", "try stratawalk plan unicycle"),
        ("bracket unicycle", "try stratawalk plan unicycle"),
        ("plot line", "try stratawalk show, or stratawalk figures"),
        ("explain verdict", "try stratawalk help run"),
        ("servos", "try stratawalk run line --set servo=mg996r"),
        ("run hexapod", "try stratawalk run line --robot hexapod"),
        ("run walk", "try stratawalk run line"),
        ("run forward", "try stratawalk run line --set 'path.goal=[0.1, 0, 0]'"),
        ("plan hexapod", "try stratawalk plan line --robot hexapod"),
        ("check line", "try stratawalk check hexapod"),
        ("robots line", "try stratawalk robots hexapod"),
        ("robots spider", "stratawalk adopt FILE.urdf"),
        ("run line --robot spider.urdf", "stratawalk adopt spider.urdf"),
        ("export --format arduino", "did you mean 'header'?"),
        ("export line", "for example: stratawalk export line --robot hexapod-cl"),
        ("compare line ellipse", "walk it first: stratawalk run line"),
        ("show line", "did you mean runs/line-001?"),
        ("compare runs", "write stratawalk compare runs/a runs/b"),
        ("run line --speed 2", "--set swing_speed=1 for faster legs"),
        ("run line --set speed=2", "did you mean 'swing_speed'?"),
        ("study runs", "stratawalk compare runs"),
        (
            "study gone",
            "make one: stratawalk sweep friction-speed --out sweeps/friction-speed",
        ),
        ("sensitivities", "walk one: stratawalk run line"),
        ("plan line --physics", "use stratawalk run"),
        ("line", "try stratawalk run line"),
        ("unicycle", "try stratawalk plan unicycle"),
        ("figures bracket", "write --only panels"),
        ("figures --only 6", "did you mean 'line'?"),
        ("run line ellipse", "one word too many: stratawalk run; for example"),
        ("robots hexapod quadruped", "one word too many: stratawalk robots; see"),
        ("run line -o there", "write --out there"),
        ("run --scenario line", "stratawalk run line"),
        ("check --robot hexapod", "stratawalk check hexapod"),
        ("run line --gui", "then stratawalk view"),
        ("run line --headless", "write --no-video"),
        ("run stairs", "stratawalk scenarios line > stairs.toml"),
        ("plan parking", "try stratawalk plan car"),
        ("reproduce", "try stratawalk figures"),
        ("optimise line", "try stratawalk plan line --optimise time"),
        ("play gait.csv", "stratawalk play hexapod examples/tripods.csv"),
        ("scenario line", "did you mean stratawalk scenarios line?"),
        ("robot hexapod", "did you mean stratawalk robots hexapod?"),
        ("runs line", "did you mean stratawalk run line?"),
        ("gallop", "begin with stratawalk run line"),
        ("slope 0.1", "try stratawalk run line --set slope=0.1"),
        ("movie", "try stratawalk film"),
        ("run --robot", "for example: stratawalk run line"),
        ("run line hexapod", "write --robot hexapod"),
        ("run line friction=0.5", "write --set friction=0.5"),
        ("run line --set friction 0.5", "write --set friction=0.5"),
        ("run line --fric 0.5", "write --set friction=0.5"),
        ("run line --replay", "stratawalk view takes it"),
        ("--robot hexapod run line", "try stratawalk run line --robot hexapod"),
        ("run line.toml", "give 'line', as shipped, or a TOML file"),
        ("sweep legs.toml --out there", "give 'legs', as shipped, or a TOML file"),
        ("run line --robot hexapod.xml", "give 'hexapod', as shipped, or the path"),
        ("view 1", "finished run, as stratawalk run line makes"),
        ("fit hexapod", "stratawalk fit hexapod LOG.csv"),
        ("run line --goal 0.1 0.2", "write --set 'path.goal=[0.1, 0.2, 0]'"),
        ("run line --goal=y=0.2", "write --set 'path.goal=[0, 0.2, 0]'"),
        ("plan car --trailers 2", "try stratawalk plan car-trailers --set trailers=2"),
        ("run line --steps 4", "stratawalk run; write --segments 4"),
        ("run line --predict compliant", "--set 'predictions=[\"compliant\"]'"),
        ("help floor", "--set floor_stiffness=VALUE (a number from 100 to 1000000"),
        ("help friction", "--set friction=VALUE (a number from 0 to 10): "),
        ("run line --set floor=soft", "did you mean 'floor_stiffness'?"),
        ("run line --floor 1e4", "write --set floor_stiffness=1e4"),
        ("run line --softer", "write --set floor_stiffness=1e4 for the floor"),
        ("settings", "try stratawalk scenarios line, which lists all"),
        ("robots --list", "leave it out: stratawalk robots"),
        ("plan car --plot", "for a system write --out plan.png"),
        ("plan unicycle --goal y 2", "'y' gives no value: --goal; write"),
    ],
)
def test_a_first_guess_is_answered_with_a_command_that_works(
    words, meant, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mybot.xml").write_text("<mujoco model='mybot'><worldbody/></mujoco>")
    (tmp_path / "mu.toml").write_text('scenario = "line"\n[grid]\nmu = [0.1, 0.3]\n')
    (tmp_path / "top.toml").write_text('scenario = "line"\nfriction = [0.1, 0.3]\n')
    (tmp_path / "fric").mkdir()
    (tmp_path / "fric" / "sweep.json").touch()
    if "line-001" in words or words == "show line":
        (tmp_path / "runs" / "line-001").mkdir(parents=True)
    if words in ("compare runs", "study runs"):
        for age, name in enumerate("ba"):
            run = tmp_path / "runs" / name
            run.mkdir(parents=True)
            for file in ("scenario.toml", "summary.json"):
                (run / file).touch()
                os.utime(run / file, (1e9 - age, 1e9 - age))
    assert main(words.split()) in (2, 3)
    (line,) = capsys.readouterr().err.splitlines()
    assert meant in line


@pytest.mark.parametrize("command", COMMANDS)
def test_the_example_of_a_command_is_one_that_it_takes(command):
    """Commands that need words have one; what is redirected is the shell's."""
    example = COMMANDS[command].get("example", f"stratawalk {command}")
    words = example.partition(" >")[0].partition(" <")[0].split()
    assert words[:2] == ["stratawalk", command]
    parser().parse_args(words[1:])


@pytest.mark.parametrize("hint", GUESSES["commands"].values())
def test_what_is_offered_in_place_of_a_command_is_one(hint):
    offered = re.findall(r"stratawalk (\w+)", hint)
    assert offered
    assert set(offered) <= {*COMMANDS, "help"}


@pytest.mark.parametrize("words", ["version", "-V", "--version"])
def test_the_version_is_told_however_it_is_asked_for(words, capsys):
    with suppress(SystemExit):
        assert main([words]) == 0
    assert re.fullmatch(r"stratawalk \d+\.\d+\.\d+\S*\n", capsys.readouterr().out)


def test_the_name_of_the_program_may_stand_there_too(capsys):
    assert main([*["stratawalk"] * 5000, "systems", "unicycle"]) == 0
    assert capsys.readouterr().out.startswith("unicycle ")


def test_one_system_is_told_by_its_name(capsys):
    assert main(["systems", "unicycle"]) == 0
    assert capsys.readouterr().out.startswith("unicycle ")


def test_without_a_run_the_newest_one_is_taken_and_named(
    folder, tmp_path, monkeypatch, capsys
):
    """Whatever its name is; that one was walked last."""
    monkeypatch.chdir(tmp_path)
    for name, age in (("line-001", 100), ("ellipse-001", 50)):
        shutil.copytree(folder, tmp_path / "runs" / name)
        summary = tmp_path / "runs" / name / "summary.json"
        os.utime(summary, (1e9 - age, 1e9 - age))
    assert main(["show"]) == 0
    said = capsys.readouterr()
    assert said.out.strip().endswith("ellipse-001/report.html")
    assert f"the newest run, {Path('runs', 'ellipse-001')}" in said.err


def test_what_to_cite_is_told_for_the_program_and_for_a_run(folder, capsys):
    assert main(["cite"]) == 0
    alone = capsys.readouterr().out
    assert re.findall(r"@\w+\{(\w+),", alone) == ["stratawalk", "goodwine2000"]
    assert "VERSION" not in alone
    assert main(["cite", str(folder)]) == 0
    used = re.findall(r"@\w+\{(\w+),", capsys.readouterr().out)
    assert {"lafferriere1991", "todorov2012", "murphey2006"} < set(used)
    assert "sucan2012" not in used


def test_the_version_of_a_run_ends_no_entry_of_a_bibliography(folder, capsys):
    sealed(folder, versions={"stratawalk": "1.0}}\n@misc{evil, title = {x}"})
    assert main(["cite", str(folder)]) == 0
    said = capsys.readouterr().out
    assert "version = {1.0miscevil" in said
    assert "@misc{evil" not in said


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run line --draw -1", "-1 is not allowed: --draw; give a whole number, 0 or"),
        ("run line --tries 0", "0 is not allowed: --tries; give a whole number, 1 or"),
        ("run line --tolerance a", "a is not a share of the path: --tolerance; give"),
        ("export line --format csv --out x --rate 0", "0 is not a rate: --rate; give"),
        ("design hexapod --designs 1.5", "1.5 is not allowed: --designs; give"),
        (
            "sweep legs --out x --shard 5/4",
            "no part 5 of 4: --shard; give I/N with I from 1",
        ),
    ],
)
def test_a_number_out_of_range_is_refused_with_one_that_is_not(words, said, capsys):
    assert main(words.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
