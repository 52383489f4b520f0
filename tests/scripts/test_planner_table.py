"""Other planners reach the goals of shipped systems, and ours undercut no bound."""

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from models import equations, load, shipped_system
from planner import Execution, aim, extend, line, play
from scripts.planner_table import controls, optimised, sampled
from sim import cli

TRIPODS = ("g1_1", "g2_2")  # fields of the strokes of each tripod
ELEMENTS = (*TRIPODS, "g1_2", "g2_1", "[g1_1,g2_2]")
TASKS = {  # a hexapod, and where it is to go
    "unit-free": (lambda: shipped_system("paper-hexapod").system, (1.0, 1.0, 0.0)),
    "a segment of line": (
        lambda: equations(load("hexapod")).system,
        (0.15 / 40, 0.15 / 40, 0.0),
    ),
}


def off(problem, strokes):
    end = play(problem.system, strokes, problem.states[0])[-1]
    return np.linalg.norm(end - problem.states[1])


def test_controls_are_the_fields_that_elements_are_made_of():
    assert controls(shipped_system("unicycle")) == ("drive", "turn")


@pytest.mark.parametrize("name", TASKS)
def test_one_aimed_segment_in_shortest_words_is_a_shortest_path(name):
    """Of arcs of the tripods' radius, as Reeds and Shepp have them."""
    base = pytest.importorskip("ompl.base", exc_type=ImportError)
    make, goal = TASKS[name]
    hexapod = extend(make(), ELEMENTS)
    there = np.pad(goal, (0, hexapod.system.dimension - 3))
    stride, _, yaw_gain = hexapod.columns(np.zeros_like(there))[:3, 0].tolist()
    space = base.ReedsSheppStateSpace(stride / yaw_gain)
    ends = [space.allocState(), space.allocState()]
    for state, (x, y, yaw) in zip(ends, ((0.0, 0.0, 0.0), goal), strict=True):
        state.setXY(x, y)
        state.setYaw(yaw)
    bound = space.distance(*ends) / stride
    aimed = partial(aim, hexapod, line(np.zeros_like(there), there), 1)

    def travel(words):
        flows = aimed(execution=Execution(coordinates=words)).flows
        return sum(abs(flow.duration) for flow in flows if flow.field in TRIPODS)

    # at a minimum, an aim off by 1e-9 costs as much and no more
    assert travel("shortest") == pytest.approx(bound, abs=1e-8)
    assert travel("backward") > bound


def test_optimised_strokes_meet_the_goal_on_the_exact_kinematics():
    pytest.importorskip("casadi", exc_type=ImportError)
    problem = shipped_system("brockett")
    strokes = optimised(problem)
    assert len(strokes) <= 12
    assert off(problem, strokes) < 1e-6


def test_sampled_strokes_are_of_single_fields_and_come_closer_to_the_goal():
    pytest.importorskip("ompl", exc_type=ImportError)
    problem = shipped_system("heisenberg")
    strokes = sampled(problem, seconds=0.5)
    assert {stroke.field for stroke in strokes} <= set(controls(problem))
    assert 1e-6 < off(problem, strokes) < off(problem, [])  # it samples


def test_peers_that_are_not_installed_are_said_in_one_line(monkeypatch, capsys):
    """By pip outside a checkout, which has a command of its own."""
    monkeypatch.setattr("planner.errors.SETUP", Path("no checkout"))
    monkeypatch.setattr("sim.commands.doctor.find_spec", lambda name: None)
    assert cli.main(["bench", "--peers"]) == 2
    assert capsys.readouterr().err == (
        "stratawalk: error: package 'casadi' is not installed: the extra 'peers'; "
        "pip install 'stratawalk[peers]'\n"
    )


def test_the_command_runs_the_script_where_there_is_one(monkeypatch, tmp_path, capfd):
    monkeypatch.setattr("sim.commands.doctor.ROOT", tmp_path)
    monkeypatch.setattr("sim.commands.doctor.find_spec", bool)
    assert cli.main(["bench", "--peers"]) == 2
    assert "run it in a checkout of the project" in capfd.readouterr().err
    (tmp_path / "scripts").mkdir()
    (tmp_path / "scripts" / "__init__.py").touch()
    script = tmp_path / "scripts" / "planner_table.py"
    script.write_text("import sys\nprint([sys.argv[1]])\n")
    assert cli.main(["bench", "--peers", "--json"]) == 0
    assert json.loads(capfd.readouterr().out.replace("'", '"')) == ["--json"]
