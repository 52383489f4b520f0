"""Ways that are found: clear of obstacles, walkable, the same every time."""

import dataclasses
import sys

import numpy as np
import pytest

from planner.errors import BoundError
from sim import nominal
from sim.errors import UsageError
from sim.obstacles import route, shapes
from sim.obstacles.clearance import surroundings
from sim.obstacles.route import routed
from sim.scenario_file import dumps, load
from sim.setup import prepare

BEHIND = [{"kind": "box", "center": [0.45, 0.0], "size": [0.1, 0.5]}]


@pytest.fixture(scope="module")
def detour():
    return routed(prepare(load("detour")))


def clearance(setup, path):
    """Of the robot standing with legs at rest, densely along a path."""
    around = surroundings(setup)
    poses = path.curve.at(np.linspace(0, 1, 3001))
    angles = np.zeros((len(poses), len(setup.robot.groups)))
    return around.sweep(around.outline.configurations(poses, angles, angles)).least


def test_the_straight_line_is_blocked_and_the_way_found_is_clear(detour):
    goal = detour.scenario.path.goal
    assert clearance(detour, nominal.line(goal)).min() < 0
    # room for the tube is kept at samples; arcs become chords between them
    assert clearance(detour, detour.scenario.path).min() > detour.scenario.min_clearance


def test_the_way_leads_from_the_start_to_the_goal(detour):
    path = detour.scenario.path
    assert path.kind == "waypoints"
    assert path(0.0) == pytest.approx((0, 0, 0), abs=0)
    assert path(1.0)[:2] == pytest.approx(path.goal[:2], abs=0)
    turns = (path(1.0)[2] - path.goal[2]) / (2 * np.pi)
    assert turns == pytest.approx(round(turns))
    assert len(path.parameter) == detour.scenario.segments + 1


def test_the_robot_goes_where_it_is_heading(detour):
    """Sideways steps would need brackets, and a wide tube with them."""
    poses = np.array(detour.scenario.path.parameter)
    steps, yaw = np.diff(poses, axis=0), (poses[1:, 2] + poses[:-1, 2]) / 2
    sideways = np.abs(steps[:, 1] * np.cos(yaw) - steps[:, 0] * np.sin(yaw)).sum()
    assert sideways < 0.03 * detour.scenario.path.length  # 0.01 measured: chords


def test_the_same_way_is_found_again(detour):
    again = routed(prepare(load("detour")))
    assert again.scenario.path.parameter == detour.scenario.path.parameter


def test_the_way_found_is_what_the_scenario_s_file_holds(detour, tmp_path):
    file = tmp_path / "found.toml"
    file.write_text(dumps(detour.scenario))
    assert load(str(file)).path.parameter == detour.scenario.path.parameter


def test_without_obstacles_the_way_is_straight():
    setup = prepare(load("detour", {"obstacles": []}))
    assert routed(setup).scenario.path == nominal.line(setup.scenario.path.goal)


def test_a_path_that_is_given_is_left_alone():
    setup = prepare(load("line"))
    assert routed(setup) is setup


def shut(*tables):
    scenario = load("detour", {"path.goal": [0.9, 0.0, 0.0]})
    return prepare(dataclasses.replace(scenario, obstacles=shapes.decode(tables)))


@pytest.mark.parametrize(
    "wall",
    [
        {"kind": "box", "center": [0.9, 0.0], "size": [0.2, 0.2]},
        {"kind": "wall", "points": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5],
                                    [-0.5, -0.5]]},
    ],
    ids=["on the goal", "around the start"],
)  # fmt: skip
def test_where_there_is_no_way_it_says_so(wall, monkeypatch):
    monkeypatch.setattr(route, "TRIALS", 200)
    message = r"no way found to \(0\.9, 0, 0\) that keeps 10\.0 mm from all obstacles"
    with pytest.raises(BoundError, match=message):
        routed(shut(wall))


def test_what_finds_the_way_may_be_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "ompl", None)
    with pytest.raises(UsageError, match="finding one needs OMPL: path; pip install"):
        routed(shut(*BEHIND))
