"""Peers: arcs that are the robot's own, and an optimum on which all agree."""

import numpy as np
import pytest

from planner.systems.flows import flow_map
from sim import cli
from sim.bench import peers
from sim.bench.arcs import Arcs, Task, joined, travel
from sim.bench.peers import SIDES, measure, ours, tasks

TASKS = {task.name: (task, extended, segments) for task, extended, segments in tasks()}
UNIT_FREE, ONE_SEGMENT, AT_ONCE = TASKS
ROUNDING = 1e-12  # a flow is followed to the last digits


def solved(name):
    """The strokes of the planner in each of its ways."""
    return [solver.solve() for solver in ours(*TASKS[name])]


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize(("field", "side"), SIDES.items())
def test_arcs_are_the_flows_of_loaded_swings(name, field, side):
    task, extended, _ = TASKS[name]
    pose = np.array([0.1, -0.2, 0.7])
    start = np.pad(pose, (0, extended.system.dimension - 3))
    flown = flow_map(extended.system, field, start, 0.9)[:3]
    assert task.arcs.after(pose, side, 0.9) == pytest.approx(flown, abs=ROUNDING)


def test_sweeps_that_cancel_disappear():
    assert joined([(1, 0.5), (-1, 0.25), (-1, -0.25), (1, 0.5)]) == [(1, 1.0)]


def test_yaw_counts_as_error_but_whole_turns_do_not():
    task = Task("turn", Arcs(2.0, 1.0), (0.0, 0.0, np.pi))
    assert task.error([]) == pytest.approx(2.0 * np.pi)
    assert Task("turn", Arcs(2.0, 1.0), (0.0, 0.0, 2 * np.pi)).error([]) == 0


@pytest.mark.parametrize("name", TASKS)
def test_aimed_plans_meet_the_goal_as_others_see_it(name):
    _, *aimed = solved(name)
    # tolerance of aiming, in the state's mixed unit
    assert [TASKS[name][0].error(strokes) for strokes in aimed] == pytest.approx(
        [0.0, 0.0], abs=1e-9
    )


@pytest.mark.parametrize("name", [UNIT_FREE, ONE_SEGMENT])
def test_one_aimed_segment_in_shortest_words_is_a_shortest_path(name):
    ompl_peer = pytest.importorskip("sim.bench.ompl_peer", exc_type=ImportError)
    shortest = solved(name)[-1]
    bound = ompl_peer.reeds_shepp(TASKS[name][0])
    # at a minimum, an aim off by 1e-9 costs as much and no more
    assert travel(shortest) == pytest.approx(bound, abs=1e-8)


@pytest.mark.parametrize("name", TASKS)
def test_no_plan_undercuts_the_bound(name):
    ompl_peer = pytest.importorskip("sim.bench.ompl_peer", exc_type=ImportError)
    bound = ompl_peer.reeds_shepp(TASKS[name][0])
    assert min(map(travel, solved(name)[1:])) > bound - 1e-8


def test_optimum_meets_the_goal_and_is_that_of_reeds_and_shepp():
    casadi_peer = pytest.importorskip("sim.bench.casadi_peer", exc_type=ImportError)
    ompl_peer = pytest.importorskip("sim.bench.ompl_peer", exc_type=ImportError)
    task, *_ = TASKS[UNIT_FREE]
    strokes = casadi_peer.MultipleShooting(task).once()
    assert task.error(strokes) < 1e-5  # strokes left out as unused, IPOPT's tolerance
    assert travel(strokes) == pytest.approx(ompl_peer.reeds_shepp(task), abs=1e-5)


def test_sampled_sweeps_come_closer_to_the_goal(monkeypatch):
    ompl_peer = pytest.importorskip("sim.bench.ompl_peer", exc_type=ImportError)
    monkeypatch.setattr(ompl_peer, "PATIENCE", 0.2)
    task, *_ = TASKS[UNIT_FREE]
    assert task.error(ompl_peer.sampled(task, "RRT")) < task.error([])


def test_peers_that_are_not_installed_are_said_in_one_line_each(monkeypatch, capsys):
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    assert cli.main(["bench", "--peers"]) == 0
    casadi, ompl, *rows = capsys.readouterr().out.splitlines()
    left_out = "is not installed, its rows are left out: pip install"
    assert casadi.startswith(f"casadi {left_out}")
    assert ompl.startswith(f"ompl {left_out}")
    assert len(rows) == 3 * len(TASKS)


def test_without_an_optimum_no_ratio_is_claimed(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    *_, last = measure()
    assert last.over_optimum is None
    assert str(last).endswith("- of the optimum")
