"""A run folder of a stranger: files of two walks, numbers too large, and models."""

import json
import re
import resource
import shutil

import imageio.v3 as iio
import numpy as np
import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.feedback.stops import written
from sim.runs.run import read_run
from tests.commands import forbidden, refusal, run
from tests.finished_runs import sealed
from tests.sim.feedback.test_foreign_stops import STOPS
from tests.sim.test_damaged_runs import COMMANDS


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    """The folder of another walk."""
    folder = tmp_path_factory.mktemp("other") / "run"
    goal = ("--set", "path.goal=[0.004,0,0]", "--segments", "1")
    only = ("--set", 'predictions=["quasi_static"]')
    words = ("run", "line", *goal, *only, "--no-video", "--out", str(folder))
    assert main(words) == 0
    return folder


@pytest.mark.physics
@pytest.mark.parametrize("file", ["commands.npz", "trajectory.npz", "summary.json"])
def test_files_of_another_walk_are_refused(other, folder, tmp_path, capsys, file):
    """What is exported from them would go to the servos of a robot."""
    shutil.copy(other / file, folder)
    capsys.readouterr()
    words = ("export", str(folder), "--format", "csv", "--out", str(tmp_path / "e.csv"))
    assert main(words) == 2
    assert "its files are of different walks" in capsys.readouterr().err
    assert not (tmp_path / "e.csv").exists()


def moved(name):
    """Change an array of a file in the middle alone."""

    def change(path):
        with np.load(path) as file:
            kept = dict(file)
        kept[name][len(kept[name]) // 2] += 1e-3
        np.savez(path, **kept)

    return change


def reworded(own, others):
    def change(path):
        assert own in (text := path.read_text())
        path.write_text(text.replace(own, others, 1))

    return change


@pytest.mark.physics
@pytest.mark.parametrize(
    ("file", "change"),
    [
        ("commands.npz", moved("ctrl")),
        ("trajectory.npz", moved("achieved_pose")),
        ("flows.csv", reworded("swing", "lift")),
        ("model.toml", reworded("lift_angle = 0.3", "lift_angle = 0.2")),
        ("model.xml", reworded('timestep="0.001"', 'timestep="0.002"')),
        ("summary.json", reworded('"bounces": ', '"bounces": 1')),
    ],
)
def test_files_that_were_changed_are_refused(folder, tmp_path, capsys, file, change):
    change(folder / file)
    words = ("export", str(folder), "--format", "csv", "--out", str(tmp_path / "e.csv"))
    assert main(words) == 2
    assert "of different walks, or were changed" in capsys.readouterr().err
    assert not (tmp_path / "e.csv").exists()


@pytest.mark.physics
@pytest.mark.parametrize("file", ["robot/hexapod.xml", "robot/hexapod.toml"])
def test_the_robot_of_a_run_is_the_one_that_walked(edited, tmp_path, capsys, file):
    """Sensitivities and a fit would be those of another robot."""
    robot = edited("mass", "mass").path
    goal = ("--set", "path.goal=[0.004,0,0]", "--set", 'predictions=["ideal"]')
    words = ("line", "--robot", str(robot), "--segments", "1", *goal)
    folder = tmp_path / "run"
    assert main(["run", *words, "--no-video", "--out", str(folder)]) == 0
    assert main(["show", str(folder), "--no-browser"]) == 0
    kept = (folder / file).read_bytes()
    (folder / file).write_bytes(kept + b"\n")
    for words in (["show", "--no-browser"], ["sensitivities"], ["fit"]):
        assert main([words[0], str(folder), *words[1:]]) == 2
        assert "of different walks, or were changed" in capsys.readouterr().err
    (folder / file).write_bytes(kept)
    (tmp_path / "outside").write_text("of somebody else")
    for name in ("../outside", str(tmp_path / "outside")):  # which nobody opens
        told = json.loads((folder / "summary.json").read_text())
        told["seals"][name] = "0"
        (folder / "summary.json").write_text(json.dumps(told))
    assert main(["show", str(folder), "--no-browser"]) == 0


@pytest.mark.physics
@pytest.mark.parametrize(
    ("own", "others"),
    [("goal = [", "goal = [-"), ("timestep = 0.001", "timestep = 0.002")],
)
def test_a_scenario_of_another_walk_is_refused(folder, capsys, own, others):
    """Goal and path of the report would not be those that were walked to."""
    text = (folder / "scenario.toml").read_text()
    assert own in text
    (folder / "scenario.toml").write_text(text.replace(own, others))
    assert main(["show", str(folder), "--no-browser"]) == 2
    assert "its files are of different walks" in capsys.readouterr().err


@pytest.mark.physics
@pytest.mark.parametrize(
    ("own", "others"),
    [
        ('robot = "hexapod"', 'robot = "quadruped"'),
        ("friction = 1.0", "friction = 0.5"),
    ],
)
def test_settings_that_were_not_walked_with_are_refused(folder, capsys, own, others):
    """Sensitivities would be those of a friction that the walk did not have."""
    text = (folder / "scenario.toml").read_text()
    assert own in text
    (folder / "scenario.toml").write_text(text.replace(own, others))
    for words in (["show", "--no-browser"], ["sensitivities"], ["fit"]):
        assert main([words[0], str(folder), *words[1:]]) == 2
        assert "of different walks, or were changed" in capsys.readouterr().err


@pytest.mark.physics
def test_a_path_that_leads_farther_than_pictures_have_numbers_is_refused(folder):
    text = (folder / "scenario.toml").read_text()
    far = re.sub(r"goal = \[.*", "goal = [1e6, 0.0, 1e6]", text)
    (folder / "scenario.toml").write_text(far)
    sealed(folder)
    with pytest.raises(UsageError, match=r"its path leads 1e\+06 m away"):
        read_run(folder)


@pytest.mark.physics
def test_what_decides_no_walk_may_be_changed_in_a_runs_settings(folder):
    text = (folder / "scenario.toml").read_text()
    free = ('name = "short"', 'name = "mine"'), ("plan_time = 3", "plan_time = 4")
    for own, others in free:
        assert own in text
        text = text.replace(own, others)
    (folder / "scenario.toml").write_text(text)
    assert read_run(folder).settings["name"] == "mine"


@pytest.mark.parametrize("name", ["trajectory.npz", "model.xml", "robot.xml"])
def test_files_that_may_not_be_read_are_named_with_that_reason(folder, hexapod, name):
    shutil.copy(hexapod.path, folder / "robot.xml")
    show = ["show", folder, "--no-browser"]
    words = ["robots", folder / name] if name == "robot.xml" else show
    (folder / name).chmod(0)
    done = forbidden(*words)
    assert done.returncode == 6
    assert f"error: Permission denied: {folder / name}; check the path" in done.stderr


@pytest.mark.physics
@pytest.mark.parametrize(
    ("table", "key", "value", "said"),
    [
        ("weighed", "prediction", "x", "unknown prediction 'x'"),
        ("weighed", "prediction", {}, "prediction is {}, which is no text"),
        ("achieved", "slip", 1e308, "1e+308 is not a number below 1e+09"),
    ],
)
def test_a_summary_of_what_cannot_be_is_refused(
    folder, capsys, table, key, value, said
):
    summary = json.loads((folder / "summary.json").read_text())
    summary[table][key] = value
    sealed(folder, **summary)
    assert main(["show", str(folder), "--no-browser"]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.physics
@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("phase", lambda rows: rows + 1, "a row of a phase not in flows.csv"),
        ("phase", lambda rows: rows - 1, "a row of a phase not in flows.csv"),
        ("phase", lambda rows: rows * 1.0, "a row of a phase not in flows.csv"),
        ("time", lambda rows: rows[::-1], "are not in time's order"),
        ("time", lambda rows: rows * 1e-3, "has not the times of flows.csv"),
        ("time", lambda rows: rows + 1.0, "has not the times of flows.csv"),
        ("time", lambda rows: [*rows[:-1], rows[-1] - 5e-3], "has not the times of"),
        ("time", lambda rows: rows * 1.01, "commands.npz has not the times of flows"),
    ],
)
def test_rows_that_no_walk_has_are_refused(folder, name, change, said):
    """Films index the phases by them, and search for moments."""
    path = folder / ("commands.npz" if "commands" in said else "trajectory.npz")
    with np.load(path) as file:
        kept = dict(file)
    np.savez(path, **kept | {name: change(kept[name])})
    sealed(folder)
    with pytest.raises(UsageError, match=said):
        read_run(folder)


@pytest.mark.physics
def test_a_walk_stops_once_in_a_segment_at_most(folder):
    stops = [STOPS[0]._replace(segment=n, time=n + 1.0) for n in range(99)]
    (folder / "feedback.csv").write_text(written(stops))
    sealed(folder)
    with pytest.raises(UsageError, match="has more stops than the walk has segments"):
        read_run(folder)


@pytest.mark.physics
@pytest.mark.parametrize("form", ["csv", "ros2", "header", "dynamixel"])
def test_angles_that_no_joint_turns_to_are_not_exported(folder, capsys, form):
    with np.load(folder / "commands.npz") as file:
        kept = dict(file)
    np.savez(folder / "commands.npz", **kept | {"ctrl": kept["ctrl"] + 9e8})
    sealed(folder)
    out = folder.parent / "out"
    words = ("export", str(folder), "--no-play", "--format", form, "--out", str(out))
    assert main(words) == 2
    said = "joint 'swing_1' is commanded from 9e+08 to 9e+08 rad"
    assert said in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.physics
@pytest.mark.parametrize(
    ("old", "new"),
    [
        (",lift,2,", ",lift,<b>,"),  # no group
        (",hold,12,", ",hold,21,"),  # not in their order
        (",lift,2,", ",lift,legs 9,"),
        ("(,lift,.*),1,", r"\1,<b>,"),
        (",swing,2,g2_1,", ",swing,2,g1_1,"),  # a field of another stratum
        (",lift,2,,", ",lift,2,g2_1,"),  # a field without a swing
        (",lift,2,,[^,]*,", ",lift,2,,1e6,"),  # many turns
        (",1\n", ",<b>\n"),  # neither as planned nor not
        (r"\n3,", r"\n4,"),  # not the next number
    ],
)
def test_a_phase_that_the_robot_cannot_have_walked_is_refused(folder, old, new):
    text = (folder / "flows.csv").read_text()
    changed = re.sub(old, new, text, count=1)
    assert changed != text
    (folder / "flows.csv").write_text(changed)
    with pytest.raises(UsageError, match="not a finished run, "):
        read_run(folder)


BOMB = '<worldbody><replicate count="3000000"><geom size="1"/></replicate></worldbody>'
FOREIGN = '<asset><texture type="2d" name="t" file="{}"/></asset>'
MODELS = [name for name in COMMANDS if name not in ("show", "compare", "cite")]
LIMITS = (10.0, 2 * 10**9)  # [s] of the processor, bytes


@pytest.mark.physics
@pytest.mark.full
@pytest.mark.parametrize("command", MODELS)
def test_the_model_of_a_run_may_be_a_bomb(walked, tmp_path, command):
    shutil.copytree(walked, tmp_path / "run")
    (tmp_path / "run" / "model.xml").write_text(f"<mujoco>{BOMB}</mujoco>")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = run(COMMANDS[command], tmp_path, MUJOCO_GL="egl")  # none has been loaded
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.returncode == 3
    assert re.search("too large: .*run/model.xml; ", refusal(done))
    assert used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime < LIMITS[0]
    assert 1024 * used.ru_maxrss < LIMITS[1]


@pytest.mark.physics
@pytest.mark.parametrize("command", MODELS)
def test_the_model_of_a_run_opens_no_files_outside_its_folder(
    walked, tmp_path, monkeypatch, capsys, command
):
    shutil.copytree(walked, tmp_path / "run")
    monkeypatch.chdir(tmp_path)
    iio.imwrite(tmp_path / "secret.png", np.zeros((8, 8, 3), np.uint8))
    model = tmp_path / "run" / "model.xml"
    opening = FOREIGN.format(tmp_path / "secret.png") + "</mujoco>"
    model.write_text(model.read_text().replace("</mujoco>", opening))
    assert main(COMMANDS[command]) == 3
    said = capsys.readouterr().err
    assert "the model opens files outside its own folder: " in said
    assert "secret.png; walk the scenario again" in said
