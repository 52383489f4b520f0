"""Peers: tasks that are the robot's own, and an optimum on which all agree."""

import json

import numpy as np
import pytest

from models import shipped_system
from planner.systems import flow_map
from scripts.bench_peers import TRIPODS, Peer, bound, ours, tasks
from scripts.peers import MultipleShooting, Task, joined, sampled, travel
from sim import cli

TASKS = {
    task.problem.name: (task, hexapod, segments) for task, hexapod, segments in tasks()
}
UNIT_FREE, ONE_SEGMENT, AT_ONCE = TASKS
ROUNDING = 1e-12  # a flow is followed to the last digits


def solved(name):
    """The strokes of the planner in each of its ways."""
    return [solve() for _, solve, _ in ours(*TASKS[name])]


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("field", TRIPODS)
def test_strokes_are_the_flows_of_loaded_swings(name, field):
    task, hexapod, _ = TASKS[name]
    pose = np.array([0.1, -0.2, 0.7])
    start = np.pad(pose, (0, hexapod.system.dimension - 3))
    flown = flow_map(hexapod.system, field, start, 0.9)[:3]
    stroke = flow_map(task.problem.system, field, pose, 0.9)
    assert stroke == pytest.approx(flown, abs=ROUNDING)


def test_strokes_that_cancel_disappear():
    left, right = TRIPODS
    strokes = [(left, 0.5), (right, 0.25), (right, -0.25), (left, 0.5)]
    assert joined(strokes) == [(left, 1.0)]


def test_strokes_of_single_fields_end_where_their_flows_lead():
    task = Task(shipped_system("unicycle"))
    assert task.fields == ("drive", "turn")
    end = task.end([("drive", 1.0), ("turn", np.pi / 2), ("drive", 2.0)])
    assert end == pytest.approx([1, 2, np.pi / 2], abs=ROUNDING)


def test_an_error_in_yaw_counts_at_the_circles_radius():
    task, *_ = TASKS[ONE_SEGMENT]
    left, right = TRIPODS
    goal = task.problem.states[1]
    turned = task.end([(left, 0.1), (right, -0.1)]) - goal
    radius = task.scale[0]
    error = np.hypot(np.hypot(*turned[:2]), radius * turned[2])
    assert task.error([(left, 0.1), (right, -0.1)]) == pytest.approx(error)


@pytest.mark.parametrize("name", TASKS)
def test_aimed_plans_meet_the_goal_as_others_see_it(name):
    _, *aimed = solved(name)
    # tolerance of aiming, in the state's mixed unit
    assert [TASKS[name][0].error(strokes) for strokes in aimed] == pytest.approx(
        [0.0, 0.0], abs=1e-9
    )


@pytest.mark.parametrize("name", [UNIT_FREE, ONE_SEGMENT])
def test_one_aimed_segment_in_shortest_words_is_a_shortest_path(name):
    pytest.importorskip("ompl", exc_type=ImportError)
    shortest = solved(name)[-1]
    # at a minimum, an aim off by 1e-9 costs as much and no more
    assert travel(shortest) == pytest.approx(bound(TASKS[name][0]), abs=1e-8)


@pytest.mark.parametrize("name", TASKS)
def test_no_plan_undercuts_the_bound(name):
    pytest.importorskip("ompl", exc_type=ImportError)
    assert min(map(travel, solved(name)[1:])) > bound(TASKS[name][0]) - 1e-8


def test_optimum_meets_the_goal_and_is_that_of_reeds_and_shepp():
    pytest.importorskip("casadi", exc_type=ImportError)
    pytest.importorskip("ompl", exc_type=ImportError)
    task, *_ = TASKS[UNIT_FREE]
    strokes = MultipleShooting(task).once()
    assert task.error(strokes) < 1e-5  # strokes left out as unused, IPOPT's tolerance
    assert travel(strokes) == pytest.approx(bound(task), abs=1e-5)


def test_optimised_strokes_meet_the_goal_on_the_exact_kinematics():
    pytest.importorskip("casadi", exc_type=ImportError)
    task = Task(shipped_system("brockett"))
    strokes = MultipleShooting(task).once()
    assert len(strokes) <= 12
    assert task.error(strokes) < 1e-6


def test_sampled_strokes_come_closer_to_the_goal():
    pytest.importorskip("ompl", exc_type=ImportError)
    task, *_ = TASKS[UNIT_FREE]
    assert task.error(sampled(task, seconds=1.0)) < task.error([])


def test_sampled_controls_are_single_fields():
    pytest.importorskip("ompl", exc_type=ImportError)
    task = Task(shipped_system("heisenberg"))
    strokes = sampled(task, seconds=0.2)
    assert {name for name, _ in strokes} <= set(task.fields)
    assert task.error(strokes) > 1e-6  # it samples


def test_peers_that_are_not_installed_are_said_in_one_line(monkeypatch, capsys):
    monkeypatch.setattr("sim.commands.bench.find_spec", lambda name: None)
    assert cli.main(["bench", "--peers"]) == 2
    assert capsys.readouterr().err == (
        "stratawalk: error: package 'casadi' is not installed: the extra 'peers'; "
        "pip install 'stratawalk[peers]'\n"
    )


def test_a_planner_is_compared_with_the_optimum():
    peer = Peer("line", "ours", 0.001, 1e-9, 2.0, 4, 1.25)
    assert str(peer).endswith("2.000 rad in   4 strokes, 1.2500 of the optimum")


def test_the_command_runs_the_script_where_there_is_one(monkeypatch, tmp_path, capfd):
    monkeypatch.setattr("sim.commands.bench.ROOT", tmp_path)
    monkeypatch.setattr("sim.commands.bench.find_spec", bool)
    assert cli.main(["bench", "--peers"]) == 2
    assert "run it in a checkout of the project" in capfd.readouterr().err
    (tmp_path / "scripts").mkdir()
    (tmp_path / "scripts" / "__init__.py").touch()
    script = tmp_path / "scripts" / "bench_peers.py"
    script.write_text("import sys\nprint([sys.argv[1]])\n")
    assert cli.main(["bench", "--peers", "--json"]) == 0
    assert json.loads(capfd.readouterr().out.replace("'", '"')) == ["--json"]
