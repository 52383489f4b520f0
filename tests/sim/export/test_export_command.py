"""`stratawalk export`: a walk leaves for its servos, comes back and is played."""

import json
import shutil
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from sim.cli import main
from sim.export import source
from sim.export.source import from_run, servos
from sim.folder import RunFolder
from sim.run_folder import run
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from sim.templates import render
from tests.finished_runs import sealed
from tests.walks import COSTLY

SHORT = (
    *("--robot", "hexapod-classroom", "--segments", "1"),
    *("--set", 'predictions=["quasi_static"]'),
)


@pytest.fixture(scope="module")
def classroom(tmp_path_factory):
    """Run folder of a centimetre on servos with counts and a rate."""
    folder = tmp_path_factory.mktemp("classroom")
    path = line((0.01, 0.0, 0.0))
    robot = "hexapod-classroom"
    summary = run(
        Scenario(name="short", robot=robot, segments=1, path=path),
        RunFolder(folder),
        without=COSTLY,
    )
    return folder, summary


def judged_otherwise(folder, to, **changes):
    """A copy of a run folder with another summary."""
    shutil.copytree(folder, to)
    told = json.loads((to / "summary.json").read_text())
    weighed = told["weighed"] | changes.pop("weighed", {})
    sealed(to, **changes, weighed=weighed)
    return to


def exported(capsys, *words):
    assert main(["export", *map(str, words), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.physics
@pytest.mark.parametrize("form", ["header", "csv", "ros2"])
def test_what_servos_take_as_it_is_leads_where_the_run_led(
    classroom, tmp_path, capsys, form
):
    folder, summary = classroom
    out = tmp_path / "walk"
    told = exported(capsys, folder, "--format", form, "--out", out)
    played, achieved = told["exported"], summary["achieved"]
    # the run's commands are on counts already; what is left is rounding of angles,
    # 5e-10 rad in YAML, and what contacts make of it; 4e-11 m and rad were measured
    assert played["pose"] == pytest.approx(achieved["pose"], abs=1e-8)
    assert played["min_margin"] == pytest.approx(achieved["min_margin"], abs=1e-8)
    assert played["slip"] == pytest.approx(achieved["slip"], rel=1e-6)
    rate = 25e6 / 4096 / 102  # which a PCA9685 gives that is asked for 60
    assert told["rate"] == pytest.approx(rate)
    steps = len(np.load(folder / "commands.npz")["time"])
    assert told["commands"] == 1 + int((steps - 1) * 0.001 * rate + 1e-6)
    off = summary["error"]["quasi_static"]["position"]
    assert played["error"]["quasi_static"]["position"] == pytest.approx(off, abs=1e-8)


@pytest.mark.physics
def test_a_trajectory_is_judged_as_held_and_as_interpolated(
    classroom, tmp_path, capsys
):
    folder, summary = classroom
    words = (folder, "--format", "ros2", "--out", tmp_path / "walk.yaml")
    told = exported(capsys, *words)
    apart = np.subtract(told["interpolated"]["pose"], summary["achieved"]["pose"])
    # 1 um, while rounding to nine digits moves the end by some 1e-11 m
    assert 1e-7 < np.hypot(*apart[:2]) < 1e-4
    assert "interpolated" not in exported(
        capsys, folder, "--format", "csv", "--out", tmp_path / "walk.csv"
    )


@pytest.mark.physics
def test_what_whole_counts_cost_is_told(classroom, tmp_path, capsys):
    words = ("--format", "dynamixel", "--out", str(tmp_path / "ticks.csv"))
    assert main(["export", str(classroom[0]), *words]) == 0
    said, noticed = capsys.readouterr()
    assert "its servos take pulses; ticks are 4096 a turn" in noticed
    assert "mounting assumed: channels in the order of joints" in noticed
    assert "since angles are rounded to counts of 1.53 mrad: plan on whole" in said
    assert "--set resolution=0.00153398" in said  # a turn over 4096


@pytest.mark.parametrize(
    ("rated", "coarse", "remedy"),
    [
        (0.0, 0.0, ": plan at this rate with --set command_rate=50"),
        (0.0, 0.002, "its counts with --set command_rate=50 --set resolution=0.002"),
        (50.0, 0.002, ": plan on whole counts with --set resolution=0.002"),
        (50.0, 0.0, "from the end of the walk itself"),  # nothing that a setting mends
    ],
)
def test_what_an_export_costs_is_told_with_all_that_mends_it(rated, coarse, remedy):
    played = SimpleNamespace(bounces=0, changed=0.02)
    commands = SimpleNamespace(angles=[], joints=(), rate=50.0)
    shown = [("exported", played, "")]
    found = {
        "servo": {"rate": rated},
        "coarse": coarse,
        "commands": commands,
        "played": shown,
    }
    text = render("export.txt", scenario="line", robot="hexapod", file="f", **found)
    (line,) = (line for line in text.splitlines() if "2 % of the path" in line)
    assert line.endswith(remedy)


@pytest.mark.physics
def test_what_cannot_be_played_is_no_file(classroom, tmp_path, capsys, monkeypatch):
    def play(*_, **__):
        assert out.exists()
        raise KeyError("foot_1")

    out = tmp_path / "walk.csv"
    monkeypatch.setattr(source, "play", play)
    words = ("export", str(classroom[0]), "--format", "csv", "--out", str(out))
    assert main(words) == 2
    assert "its files do not fit together" in capsys.readouterr().err
    assert not out.exists()


def test_a_walk_that_did_not_arrive_is_exported_with_a_warning(
    classroom, tmp_path, capsys
):
    text = "drifted: it was off"
    folder = judged_otherwise(
        classroom[0], tmp_path / "run", verdict="drifted", verdict_text=text
    )
    out = tmp_path / "walk.csv"
    words = ("--format", "csv", "--out", str(out), "--no-play")
    assert main(["export", str(folder), *words]) == 0
    assert "warning: the walk that was exported drifted: it was" in (
        capsys.readouterr().err
    )
    assert out.exists()


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"weighed": {"goal": 0.3}}, 7),
        ({"weighed": {"farthest": 0.3}}, 7),
        ({"verdict": "fell", "verdict_text": "fell at 3.0 s: it tilted"}, 4),
    ],
)
def test_a_walk_that_came_out_elsewhere_is_written_and_ends_otherwise(
    classroom, tmp_path, capsys, changes, code
):
    folder = judged_otherwise(classroom[0], tmp_path / "run", **changes)
    words = ["export", str(folder), "--format", "csv", "--no-play"]
    assert main([*words, "--out", str(tmp_path / "walk.csv")]) == code
    assert "correct the walk before servos carry it out" in capsys.readouterr().err
    assert (tmp_path / "walk.csv").exists()
    again = [*words, "--out", str(tmp_path / "other.csv"), "--tolerance", "none"]
    assert main(again) == (4 if code == 4 else 0)


def test_angles_are_the_commands_of_the_run_at_their_instants(walked, tmp_path, capsys):
    out = tmp_path / "walk.csv"
    told = exported(capsys, walked, "--format", "csv", "--out", out, "--no-play")
    assert told["exported"] is None
    assert told["rate"] == 50  # of a run without a rate
    values = np.genfromtxt(out, delimiter=",", names=True)
    ctrl = np.load(walked / "commands.npz")["ctrl"]
    names = values.dtype.names
    assert names[:3] == ("time", "swing_1", "lift_1")
    assert len(names) == 1 + ctrl.shape[1]
    assert len(values) == np.ceil(len(ctrl) / 20)
    for number, name in enumerate(names[1:]):
        assert (values[name] == ctrl[::20, number]).all(), name


def test_a_walk_for_servos_of_no_rate_is_noticed(walked, tmp_path, capsys):
    words = ("--format", "ros2", "--rate", "100", "--no-play")
    code = main(["export", str(walked), *words, "--out", str(tmp_path / "walk.yaml")])
    assert code == 0
    said = capsys.readouterr()
    assert "--set command_rate=100" in said.err
    assert "100 a second" in said.out
    points = yaml.safe_load((tmp_path / "walk.yaml").read_text())["points"]
    assert points[1]["time_from_start"] == {"sec": 0, "nanosec": 10_000_000}


@pytest.mark.physics
def test_a_scenario_is_walked_and_nothing_else_is_written(
    tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    words = ("line", *SHORT, "--set", "path.goal=[0.005, 0, 0]", "--no-play")
    assert main(["export", *words, "--format", "header", "--out", "walk.h"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["walk.h"]
    assert "12 servos, 59.8384 a second" in capsys.readouterr().out


def test_a_servo_table_of_ros_gives_channels_and_ticks(classroom, tmp_path, capsys):
    joints = [f"{kind}_{leg}" for leg in range(1, 7) for kind in ("swing", "lift")]
    servo = "{{name: {}, id: {}, ticks: 1024, center: 512, max_radians: 5.236}}"
    servos = tmp_path / "servos.yaml"
    servos.write_text(
        "\n".join(f"- {servo.format(j, n)}" for n, j in enumerate([*joints, "head"]))
    )
    words = ("--format", "dynamixel", "--servo-table", servos, "--no-play", "--json")
    out = map(str, (*words, "--out", tmp_path / "ticks.csv"))
    assert main(["export", str(classroom[0]), *out]) == 0
    said = capsys.readouterr().err
    assert "no joint moves so: head\n" in said
    assert "mounting assumed" not in said
    values = np.genfromtxt(tmp_path / "ticks.csv", delimiter=",", names=True)
    assert values["swing_3"][0] == 512
    assert values["lift_3"].max() > 512


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--format", "csv", "--microseconds"), "only a header has pulses"),
        (("--format", "header", "--rate", "50"), "took 59.8384 a second"),
        (("--format", "csv", "--set", "friction=1"), "exported as it was walked"),
        (
            ("--format", "csv", "--replan", "--segments", "3"),
            "--segments, --replan for",
        ),
        (("--format", "header", "--servo-table", "none.yaml"), "cannot be read"),
        (("--format", "bvh"), "'bvh' is not allowed"),
        (("--format", "csv", "--rate", "0"), "is not a rate"),
    ],
)
def test_what_makes_no_sense_is_refused(classroom, tmp_path, capsys, words, said):
    out = tmp_path / "walk"
    assert main(["export", str(classroom[0]), *words, "--out", str(out)]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()


def test_a_joint_beyond_its_servo_is_refused_and_nothing_is_written(
    classroom, tmp_path, capsys
):
    folder, out = classroom[0], tmp_path / "walk.h"
    card = folder / "model.toml"
    before = card.read_text()
    card.write_text(f"{before}\n[servo.lift_4]\nlimits = [-0.2, 0.2]\n")
    code = main(["export", str(folder), "--format", "header", "--out", str(out)])
    card.write_text(before)
    assert code == 2
    assert "joint 'lift_4' goes to" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("name", ["there", "nowhere/walk", ""])
def test_a_file_that_cannot_be_made_is_refused_before_the_walk(
    tmp_path, capsys, monkeypatch, name
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").write_text("mine")
    assert main(["export", "line", "--format", "csv", "--out", name]) == 2
    assert (tmp_path / "there").read_text() == "mine"
    assert capsys.readouterr().out == ""


def test_a_folder_that_is_no_run_is_refused(tmp_path, capsys):
    out = str(tmp_path / "walk")
    assert main(["export", str(tmp_path), "--format", "csv", "--out", out]) == 2
    assert "not a finished run, it lacks scenario.toml" in capsys.readouterr().err


@pytest.mark.physics
def test_pulses_are_counts_where_microseconds_are_not_asked_for(classroom):
    source = from_run(classroom[0])
    plain, counts, pulses = (
        servos(source, "header", **asked)
        for asked in ({}, {"microseconds": False}, {"microseconds": True})
    )
    assert plain == counts
    assert plain != pulses
