"""The verdict on walks that fall, collide, slip, drift and arrive; plans refused."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from models.description.robot import FOLDER
from sim.cli import main
from sim.evaluation.assessment import evaluate, summarise
from sim.planning.soundness import Collisions
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from tests.walks import simulated

SHORT = ["--set", "path.goal=[0.01,0,0]", "--set", "timestep=0.001"]
SIDES = (
    ("1", "twist = [0.03, 0.0, 0.5]", "1 = -1, 3 = -1, 5 = -1"),
    ("2", "twist = [0.03, 0.0, -0.5]", "2 = 1, 4 = 1, 6 = 1"),
)


def lopsided(folder):
    """The legs of one side in one group, under a high load: it falls to the other."""
    for name in ("scene.xml", "hexapod.xml"):
        shutil.copy(FOLDER / name, folder / name)
    path = folder / "lopsided.xml"
    body = (folder / "hexapod.xml").read_text()
    path.write_text(body.replace('pos="0 0 0.018"', 'pos="0 0 2"'))
    head, _, _ = (FOLDER / "hexapod.toml").read_text().partition("# For a positive")
    groups = "".join(
        f"[group.{name}]\n{twist}\nlegs = {{ {legs} }}\n" for name, twist, legs in SIDES
    )
    gait = '[gait]\nstrata = ["12", "1", "12", "2", "12"]\n'
    path.with_suffix(".toml").write_text(f"{head}{groups}{gait}")
    return path


def run(robot, folder, *more):
    words = ["run", "line", "--robot", str(robot), "--no-video", "--out", str(folder)]
    return main([*words, "--segments", "1", *SHORT, *more])


def test_plan_that_tips_over_is_refused_before_walking(tmp_path, capsys):
    robot = lopsided(tmp_path)
    assert run(robot, tmp_path / "run") == 4
    line = capsys.readouterr().err
    assert "tips the robot over" in line
    assert "--allow-unstable" in line
    assert not (tmp_path / "run").exists()
    assert main(["plan", "line", "--robot", str(robot), *SHORT]) == 4
    assert (
        main(["plan", "line", "--robot", str(robot), *SHORT, "--allow-unstable"]) == 0
    )


def test_robot_that_falls_ends_with_four_and_keeps_its_files(tmp_path, capsys):
    folder = tmp_path / "run"
    assert run(lopsided(tmp_path), folder, "--allow-unstable") == 4
    out, err = capsys.readouterr()
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["verdict"] == "fell"
    assert summary["verdict_text"].startswith("fell at ")
    assert out.startswith("Fell at ")
    assert "the walk fell at" in err
    assert err.count("\n") == 1
    assert (folder / "trajectory.npz").exists()


@pytest.fixture(scope="module")
def short_walk():
    overrides = {"path.goal": [0.01, 0.0, 0.0], "segments": 1, "timestep": 0.001}
    return simulated(load_scenario("line", overrides))


def test_robot_that_walks_as_predicted_arrives(short_walk):
    assert short_walk.summary["verdict"] == "arrived"
    assert str(short_walk).startswith("Arrived ")


def changed(evaluation, **recording):
    walk = evaluation.walk
    return replace(
        evaluation,
        walk=replace(walk, recording=replace(walk.recording, **recording)),
    )


def test_robot_that_touches_itself_has_collided(short_walk):
    verdict = changed(short_walk.evaluation, self_contacts=3).verdict
    assert verdict.word == "collided"
    assert "3 times" in verdict.text


def test_robot_that_touches_a_wall_has_collided(short_walk):
    verdict = changed(short_walk.evaluation, wall_contacts=1).verdict
    assert verdict.text == "collided: the robot touched obstacles 1 time"


def moved(evaluation, **achieved):
    return replace(evaluation, achieved=replace(evaluation.achieved, **achieved))


def predicted(evaluation, **quasi_static):
    prediction = replace(evaluation.predicted["quasi_static"], **quasi_static)
    return replace(
        evaluation, predicted=evaluation.predicted | {"quasi_static": prediction}
    )


# five per cent of a path of 10 mm
@pytest.mark.parametrize(("far", "word"), [(0.00035, "arrived"), (0.0007, "drifted")])
def test_robot_beyond_a_twentieth_of_the_path_off_has_drifted(short_walk, far, word):
    evaluation = short_walk.evaluation
    foreseen = evaluation.predicted["quasi_static"].pose
    beside = foreseen + np.array([0.0, far, 0.0])
    assert moved(evaluation, pose=beside).verdict.word == word


def test_foot_beyond_a_twentieth_of_the_path_has_slipped(short_walk):
    evaluation = short_walk.evaluation
    slip = evaluation.predicted["quasi_static"].slip.copy()
    slip[-1, 2] -= 0.001
    verdict = predicted(evaluation, slip=slip).verdict
    assert verdict.word == "slipped"
    assert "leg 3" in verdict.text


def test_body_that_sinks_to_half_its_height_has_fallen(short_walk):
    evaluation = short_walk.evaluation
    weight = evaluation.achieved.center_of_mass.copy()
    weight[-1, 2] *= 0.4
    assert moved(evaluation, center_of_mass=weight).verdict.word == "fell"


def test_departure_beyond_the_tolerance_ends_with_seven(tmp_path, capsys):
    assert run("hexapod", tmp_path / "run", "--tolerance", "1e-6") == 7
    assert "off the quasi-static prediction" in capsys.readouterr().err
    assert run("hexapod", tmp_path / "other", "--tolerance", "0.5") == 0


def test_tolerance_that_is_no_share_is_refused(tmp_path, capsys):
    for bad in ("-1", "nan", "many"):
        assert run("hexapod", tmp_path / "run", "--tolerance", bad) == 2


def test_summary_names_the_verdict_first(short_walk):
    summary = summarise(evaluate(short_walk.walk, ["creep_floor"]))
    assert list(summary)[:2] == ["verdict", "verdict_text"]


def clumsy(folder):
    """The hexapod on spheres so large that neighbouring feet are almost in touch."""
    for name in ("scene.xml", "hexapod.xml", "hexapod.toml"):
        shutil.copy(FOLDER / name, folder / name)
    path = folder / "hexapod.xml"
    text = path.read_text().replace('contype="0"', 'contype="1"')
    path.write_text(text.replace('type="sphere" size="0.008"', 'size="0.0805"'))
    return path


def test_legs_that_would_touch_are_foreseen(tmp_path):
    setup = prepare(load_scenario("line", {"robot": str(clumsy(tmp_path))}))
    overlaps, down = Collisions(setup), np.zeros(2)
    assert overlaps(down, down) == {}
    found = overlaps(np.array([0.4, 0.0]), down)
    feet = {setup.model.geom(f"foot_{leg}").id for leg in (3, 5)}
    assert tuple(sorted(feet)) in found


def test_plan_whose_legs_collide_is_refused_before_walking(tmp_path, capsys):
    assert run(clumsy(tmp_path), tmp_path / "run") == 4
    line = capsys.readouterr().err
    assert "makes legs collide: foot_" in line
    assert not (tmp_path / "run").exists()
