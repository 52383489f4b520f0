"""The run folder: complete, replayable in bare MuJoCo, repeatable to the last bit."""

import csv
import json
import shutil
import tomllib
from dataclasses import replace
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models.description.robot import FOLDER
from models.library import load
from sim import simulation
from sim.cli import main
from sim.errors import SimulationError
from sim.folder import RunFolder
from sim.motion.poses import rotate
from sim.motion.stability import stability_margin
from sim.run_folder import run
from sim.scenarios.file import load_scenario
from tests.walks import COSTLY

pytestmark = pytest.mark.physics

SHORT = {"path": {"kind": "line", "goal": [0.005, 0.005, 0.025]}, "segments": 1}
CONTRACT = {
    "time", "qpos", "qvel", "achieved_pose", "predicted_pose", "contact",
    "planned_contact", "slip", "predicted_slip", "achieved_margin", "predicted_margin",
}  # fmt: skip


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """The same scenario twice; the second from the first one's scenario.toml."""
    first, second = (tmp_path_factory.mktemp(name) for name in ("first", "second"))
    run(load_scenario("line", SHORT | {"sample_every": 7}), RunFolder(first))
    run(load_scenario(str(first / "scenario.toml")), RunFolder(second))
    return first, second


@pytest.fixture(scope="module")
def arrays(folders):
    with np.load(folders[0] / "trajectory.npz") as file:
        return dict(file)


def test_the_folder_holds_what_the_contract_names(folders, arrays):
    assert {path.name for path in folders[0].iterdir()} >= {
        "scenario.toml", "model.xml", "commands.npz", "trajectory.npz", "summary.json",
        "flows.csv",
    }  # fmt: skip
    assert arrays.keys() >= CONTRACT
    rows = len(arrays["time"])
    assert all(len(arrays[name]) == rows for name in CONTRACT)
    assert arrays["slip"].shape == arrays["contact"].shape == (rows, 6)


def test_commands_replay_bit_for_bit_in_bare_mujoco(folders, arrays):
    model = mujoco.MjModel.from_xml_path(str(folders[0] / "model.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    with np.load(folders[0] / "commands.npz") as commands:
        time, ctrl = commands["time"], commands["ctrl"]
    assert time == pytest.approx(np.arange(len(ctrl)) * model.opt.timestep)
    replayed = []
    for step, row in enumerate(ctrl, start=1):
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
        if step % 7 == 0 or step == len(ctrl):
            replayed.append(np.concatenate([data.qpos, data.qvel]))
    recorded = np.concatenate([arrays["qpos"], arrays["qvel"]], axis=1)
    assert np.array_equal(recorded, replayed)


def test_every_row_is_of_one_instant(folders, arrays):
    """What bare MuJoCo says of a row's qpos and qvel is what the row says."""
    model = mujoco.MjModel.from_xml_path(str(folders[0] / "model.xml"))
    data = mujoco.MjData(model)
    with np.load(folders[0] / "commands.npz") as commands:
        ctrl = np.append(commands["ctrl"], commands["ctrl"][-1:], axis=0)
    feet = [model.sensor(f"contact_foot_{leg}").adr[0] for leg in range(1, 7)]
    weight = -model.opt.gravity[2] * model.body("torso").subtreemass[0]
    step = np.rint(arrays["time"] / model.opt.timestep).astype(int)
    chosen = np.append(np.arange(0, len(step), 11), len(step) - 1)
    found = {"contact": [], "center_of_mass": [], "point": []}
    for row in chosen:
        data.qpos, data.qvel = arrays["qpos"][row], arrays["qvel"][row]
        data.ctrl = ctrl[step[row]]  # the command that moves it on
        mujoco.mj_forward(model, data)
        found["contact"].append(data.sensordata[np.add(feet, 1)] > 0.01 * weight)
        found["center_of_mass"].append(data.sensor("center_of_mass").data.copy())
        found["point"].append(data.sensordata[np.add.outer(feet, [4, 5])])
    contact, center, point = map(np.array, found.values())
    x, y, yaw = arrays["world_start_pose"]
    assert np.array_equal(arrays["contact"][chosen], contact)
    expected = rotate(center[:, :2] - (x, y), -yaw)
    # positions do not depend on the solver: rounding
    assert arrays["center_of_mass"][chosen, :2] == pytest.approx(expected, abs=1e-12)
    margin = stability_margin(point, contact, center[:, :2])
    assert arrays["achieved_margin"][chosen] == pytest.approx(margin, abs=1e-12)


def test_a_rerun_from_the_folders_scenario_gives_the_same_numbers(folders):
    for name in ("commands.npz", "trajectory.npz", "flows.csv", "model.xml"):
        assert (folders[0] / name).read_bytes() == (folders[1] / name).read_bytes()
    first, second = (json.loads((f / "summary.json").read_text()) for f in folders)
    del first["timing"], second["timing"]
    assert first == second


def test_the_last_row_is_the_state_after_the_last_command(folders, arrays):
    with np.load(folders[0] / "commands.npz") as commands:
        steps = len(commands["time"])
    assert arrays["time"][-1] == pytest.approx(steps * 0.001)
    assert arrays["time"][0] == pytest.approx(7 * 0.001)


def test_the_summary_has_the_keys_of_the_contract(folders):
    summary = json.loads((folders[0] / "summary.json").read_text())
    assert summary.keys() >= {
        "scenario", "robot", "fields", "stance", "segments", "replan", "steer", "goal",
        "path_length", "distance_walked", "contact_switches", "swing_travel",
        "contact_switches_achieved", "air_travel", "bounces", "saturated_segments",
        "walk_starts",
        "predicted", "achieved", "error", "simulated_time", "timestep", "timing",
    }  # fmt: skip
    assert summary["achieved"].keys() >= {
        "pose", "min_margin", "slip", "slip_swing", "slip_transition", "slip_per_foot",
        "creep_floor",
    }  # fmt: skip
    assert summary["timing"].keys() == {
        "compile",
        "plan",
        "simulate",
        "evaluate",
        "render",
    }
    assert summary["error"]["ideal"].keys() >= {
        "position", "yaw", "position_per_path", "position_per_walked", "farthest",
    }  # fmt: skip
    assert summary["error"]["goal"].keys() == {"position", "yaw"}


def test_flows_are_told_one_a_line_in_time_order(folders):
    with (folders[0] / "flows.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert [line["end"] for line in lines[:-1]] == [line["start"] for line in lines[1:]]
    assert lines[0]["kind"] == lines[-1]["kind"] == "hold"
    assert all(line["as_planned"] == "1" for line in lines)


def test_achieved_and_predicted_start_together_in_the_start_frame(arrays):
    held = arrays["time"] <= 0.5
    assert arrays["achieved_pose"][held][-1] == pytest.approx(np.zeros(3), abs=1e-6)
    assert np.array_equal(arrays["predicted_pose"][held], np.zeros((held.sum(), 3)))
    assert (arrays["slip"][held] == 0).all()


def test_a_path_of_no_length_walks_nowhere_and_divides_by_nothing(tmp_path):
    still = {"path": {"kind": "line", "goal": [0.0, 0.0, 0.0]}, "segments": 1}
    summary = run(load_scenario("line", still), RunFolder(tmp_path), without=COSTLY)
    assert summary["contact_switches"] == 0
    assert summary["error"]["ideal"]["position_per_path"] is None
    assert summary["error"]["ideal"]["position_per_walked"] is None
    assert summary["simulated_time"] == pytest.approx(1.0)


def test_a_walk_that_diverges_leaves_what_it_is_replayed_from(tmp_path):
    wild = SHORT | {"timestep": 0.01, "servo_stiffness": 1e6, "servo_damping": 0.0}
    with pytest.raises(SimulationError, match="diverged"):
        run(load_scenario("line", wild), RunFolder(tmp_path))
    assert {path.name for path in tmp_path.iterdir()} >= {"scenario.toml", "model.xml"}
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    with np.load(tmp_path / "commands.npz") as commands:
        assert len(commands["time"]) == len(commands["ctrl"])
        warned = []
        for row in commands["ctrl"]:
            data.ctrl = row
            mujoco.mj_step(model, data)
            warned.append(any(data.warning.number))
    assert warned == [False] * (len(warned) - 1) + [True]


def test_a_walk_that_cannot_be_judged_leaves_its_commands(tmp_path, monkeypatch):
    monkeypatch.setattr("sim.simulation.evaluate", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        run(load_scenario("line", SHORT), RunFolder(tmp_path))
    with np.load(tmp_path / "commands.npz") as commands:
        assert np.array_equal(commands["time"], np.arange(len(commands["ctrl"])) * 1e-3)


def carried_out(scenario, folder):
    """Run a robot of whose files some lie beside its folder."""
    robot = load(scenario.robot, allow_external=True)
    return run(scenario, folder, robot=robot, without=COSTLY)


BOX = {"kind": "box", "center": [0.0, 0.5], "size": [1.0, 0.1]}


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """A run of a robot in several files, moved away; the robot's own files are gone."""
    home, runs = (tmp_path_factory.mktemp(name) for name in ("home", "runs"))
    (home / "mine").mkdir()
    (home / "shapes").mkdir()
    text = (FOLDER / "hexapod.xml").read_text()
    text = text.replace('model="hexapod"', 'model="mine"')
    text = text.replace("<worldbody>", '<include file="lid.xml"/><worldbody>')
    lid = '<geom type="mesh" mesh="lid" contype="0" conaffinity="0" mass="0"/>'
    text = text.replace('<freejoint name="root"/>', f'<freejoint name="root"/>{lid}')
    (home / "mine" / "mine.xml").write_text(text)
    shutil.copy(FOLDER / "scene.xml", home / "mine")
    (home / "mine" / "mine.toml").write_text((FOLDER / "hexapod.toml").read_text())
    (home / "mine" / "lid.xml").write_text(
        '<mujoco><compiler meshdir="../shapes"/>'
        '<asset><mesh name="lid" file="lid.obj"/></asset></mujoco>'
    )
    corners = "v 0 0 0\nv .01 0 0\nv 0 .01 0\nv 0 0 .01\n"
    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (home / "shapes" / "lid.obj").write_text(corners + faces)
    mine = SHORT | {"robot": str(home / "mine" / "mine.xml"), "obstacles": [BOX]}
    first = runs / "first"
    first.mkdir()
    summary = carried_out(load_scenario("line", mine), RunFolder(first))
    shutil.rmtree(home)
    return summary, first.rename(runs / "elsewhere")


def test_a_run_goes_again_after_it_was_moved_and_its_robot_is_gone(
    moved, tmp_path, monkeypatch
):
    summary, folder = moved
    scenario = load_scenario(str(folder / "scenario.toml"))
    still = SimpleNamespace(perf_counter=lambda: 0.0)  # a clock that stands
    monkeypatch.setattr(simulation, "time", still)
    again = carried_out(scenario, RunFolder(tmp_path))
    assert again.timing["compile"] == again.timing["evaluate"] == 0.0
    assert summary["robot"] == "mine"
    for name in ("commands.npz", "trajectory.npz", "flows.csv", "model.xml"):
        assert (folder / name).read_bytes() == (tmp_path / name).read_bytes()
    assert replace(again, timing=summary.timing) == summary


def test_a_run_of_a_robot_with_files_elsewhere_is_read_on_where_that_is_allowed(
    moved, capsys
):
    folder, allowed = str(moved[1]), "--allow-external"
    for words in (("fit", folder, "--no-walking"), ("sensitivities", folder)):
        assert main([*words]) == 3
        assert "give --allow-external if you trust it" in capsys.readouterr().err
        assert main([*words, allowed, "--json"]) == 0
        assert "taken from outside the folder" in capsys.readouterr().err


def test_the_model_of_a_run_is_a_robot_itself(moved, tmp_path):
    summary, folder = moved
    robot = {"robot": str(folder / "model.xml")}
    scenario = load_scenario(str(folder / "scenario.toml"), robot)
    again = run(scenario, RunFolder(tmp_path), without=COSTLY)
    # MJCF is written with six digits
    pose = summary["achieved"]["pose"]
    assert again["achieved"]["pose"] == pytest.approx(pose, abs=1e-6)


def test_the_folders_scenario_leaves_nothing_to_the_robot_that_a_number_says(folders):
    said = tomllib.loads((folders[0] / "scenario.toml").read_text())
    assert said["stance"] == "centred"
    assert (said["servo_stiffness"], said["servo_damping"]) == (
        1000.0,
        pytest.approx(2.814, abs=1e-3),
    )
