"""Ways that are found: clear of obstacles, walkable, the same every time."""

import dataclasses
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import BoundError, ResolutionError
from planner.planning.paths import grid
from sim.errors import UsageError
from sim.obstacles.clearance import surroundings
from sim.planning import routes as route
from sim.planning.bounds import within_bounds
from sim.planning.open_loop import plan_open_loop
from sim.planning.routes import routed
from sim.preparation.setup import prepare
from sim.scenarios import body_path as nominal, obstacles as shapes
from sim.scenarios.file import dumps, load_scenario

BEHIND = [{"kind": "box", "center": [0.45, 0.0], "size": [0.1, 0.5]}]


@pytest.fixture(scope="module")
def detour():
    return routed(prepare(load_scenario("detour")))


def clearance(setup, path):
    """Of the robot standing with legs at rest, densely along a path."""
    around = surroundings(setup)
    poses = path.curve.at(np.linspace(0, 1, 3001))
    angles = np.zeros((len(poses), len(setup.robot.groups)))
    return around.clearances(around.outline.configurations(poses, angles, angles)).least


def test_the_straight_line_is_blocked_and_the_way_found_is_clear(detour):
    goal = detour.scenario.path.goal
    assert clearance(detour, nominal.line(goal)).min() < 0
    # room for the tube is kept where OMPL looks, half of it in between; the rest is
    # what chords of arcs are off them
    room = detour.scenario.min_clearance + route.SIDE_ROOM[0] / 2 - 5e-4
    assert clearance(detour, detour.scenario.path).min() > room


def test_the_way_leads_from_the_start_to_the_goal(detour):
    path = detour.scenario.path
    assert path.kind == "waypoints"
    assert path(0.0) == pytest.approx((0, 0, 0), abs=0)
    assert path(1.0)[:2] == pytest.approx(path.goal[:2], abs=0)
    turns = (path(1.0)[2] - path.goal[2]) / (2 * np.pi)
    assert turns == pytest.approx(round(turns))
    steps = np.diff(np.array(path.parameter), axis=0)
    # each of the curves between cusps gets its share of the pieces, a whole number
    assert np.hypot(*steps[:, :2].T).max() <= 1.1 * 0.02


def test_the_robot_goes_where_it_is_heading(detour):
    """Sideways steps would need brackets, and a wide tube with them."""
    poses = np.array(detour.scenario.path.parameter)
    steps, yaw = np.diff(poses, axis=0), (poses[1:, 2] + poses[:-1, 2]) / 2
    sideways = np.abs(steps[:, 1] * np.cos(yaw) - steps[:, 0] * np.sin(yaw)).sum()
    assert sideways < 0.03 * detour.scenario.path.length  # 0.01 measured: chords


def test_the_same_way_is_found_again(detour):
    again = routed(prepare(load_scenario("detour")))
    assert again.scenario.path.parameter == detour.scenario.path.parameter


def test_the_way_found_is_what_the_scenario_s_file_holds(detour, tmp_path):
    file = tmp_path / "found.toml"
    file.write_text(dumps(detour.scenario))
    assert load_scenario(str(file)).path.parameter == detour.scenario.path.parameter


def test_without_obstacles_the_way_is_straight():
    setup = prepare(load_scenario("detour", {"obstacles": []}))
    assert routed(setup).scenario.path == nominal.line(setup.scenario.path.goal)


def test_a_path_that_is_given_is_left_alone():
    setup = prepare(load_scenario("line"))
    assert routed(setup) is setup


def shut(*tables):
    scenario = load_scenario("detour", {"path.goal": [0.9, 0.0, 0.0]})
    return prepare(dataclasses.replace(scenario, obstacles=shapes.decode(tables)))


RING = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]]
GAP = 0.42  # [m]; the robot is 0.376 m wide, with raised legs 0.394 m


def test_where_there_is_no_way_it_says_so(monkeypatch):
    monkeypatch.setattr(route, "TRIALS", 200)
    message = r"no way found to \(0\.9, 0, 0\) that keeps 10\.0 mm from all obstacles"
    with pytest.raises(BoundError, match=message):
        routed(shut({"kind": "wall", "points": RING}))


def test_a_goal_inside_an_obstacle_is_refused_with_what_is_in_the_way():
    message = (
        r"the goal \(0\.9, 0, 0\) has \w+ -\d+\.\d mm from obstacle 1, where more than "
        r"5\.0 mm are required"
    )
    with pytest.raises(BoundError, match=message):
        routed(shut({"kind": "box", "center": [0.9, 0.0], "size": [0.2, 0.2]}))


@pytest.mark.parametrize("clearance", [0.009, 0.01])
def test_no_more_room_than_is_required_does_not_do(clearance):
    """Of two postures of the legs, it is the one with less room that counts."""
    around = SimpleNamespace(
        postures=lambda poses, up: np.full((1, 1), up),
        clearances=lambda qpos: SimpleNamespace(least=qpos[:, 0]),
        nearest=lambda qpos: ("leg 1", "wall"),
    )
    route._require_room(around, "goal", (0, 0, 0), [0.02, np.nextafter(0.01, 1)], 0.01)
    with pytest.raises(
        BoundError, match="leg 1 .* from obstacle wall, where more than"
    ):
        route._require_room(around, "goal", (0, 0, 0), [0.02, clearance], 0.01)


def test_a_gap_that_leaves_little_room_is_taken_where_nothing_else_is_open(monkeypatch):
    """A room with one door: less room is asked for until there is a way."""
    monkeypatch.setattr(route, "TRIALS", 2000)
    west, east, half = -0.5, 0.45, GAP / 2
    jambs = [[[east, half], [east, 0.7]], [[east, -0.7], [east, -half]]]
    box = [[east, 0.7], [west, 0.7], [west, -0.7], [east, -0.7]]
    walls = [{"kind": "wall", "points": p, "thickness": 1e-3} for p in (*jambs, box)]
    setup = routed(shut(*walls))
    least = clearance(setup, setup.scenario.path).min()
    # jambs end half a thickness short of the gap's edge
    assert 0.005 + route.SIDE_ROOM[-1] / 2 - 5e-4 < least < (GAP - 0.376) / 2 + 1e-3
    assert setup.scenario.path.length < 1.5


def test_a_trap_is_backed_out_of():
    walls = [[-0.1, 0.4], [0.5, 0.4], [0.5, -0.4], [-0.1, -0.4]]
    setup = routed(shut({"kind": "wall", "points": walls}))
    assert np.array(setup.scenario.path.parameter)[:, 0].min() < -0.2
    assert clearance(setup, setup.scenario.path).min() > 0.005


def test_what_finds_the_way_may_be_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "ompl", None)
    with pytest.raises(UsageError, match="finding one needs OMPL: path; pip install"):
        routed(shut(*BEHIND))


def test_a_long_way_in_few_segments_is_cut_until_it_can_be_followed():
    """Around the end of a wall, where no inputs follow all bends at once."""
    walls = [
        {"kind": "wall", "points": [[0.4, side * 0.18], [0.4, side * 0.8]]}
        for side in (1, -1)
    ]
    asked = {"segments": 6, "replan": False, "obstacles": walls}
    far = routed(
        prepare(load_scenario("detour", asked | {"path.goal": [0.8, 0.0, 0.0]}))
    )
    with pytest.raises(ResolutionError):
        plan_open_loop(far.recut(grid(far.scenario.path.curve, 6)))
    assert plan_open_loop(within_bounds(far)[0]).flows


def found_way(goal, states, monkeypatch):
    """A route that OMPL found, through some poses."""
    pieces = []
    way = SimpleNamespace(
        length=lambda: sum(np.hypot(*np.diff(np.array(states)[:, :2], axis=0).T)),
        interpolate=pieces.append,
        getStates=lambda: states,
    )
    monkeypatch.setattr(route, "_pose", tuple)
    search = SimpleNamespace(
        goal=goal, is_free=lambda *_: True, _once=lambda *_: way, radius=0.1
    )
    return route._Search.run(search, 0, 3), pieces


def test_a_goal_where_the_robot_stands_is_reached_in_one_piece_a_segment(monkeypatch):
    way, pieces = found_way((0.0, 0.0, 0.0), [(0.0, 0.0, 0.0)] * 2, monkeypatch)
    assert pieces == [3 + 1]
    assert way.tolist() == [[0, 0, 0]] * 2


@pytest.mark.parametrize(("turns", "last"), [(0, 2.5), (1, 2.5), (-1, 2.5)])
def test_a_way_ends_at_the_goal_s_yaw_and_the_turns_that_it_took(
    turns, last, monkeypatch
):
    yaws = np.linspace(0.0, last + turns * 2 * np.pi, 9)
    wrapped = (yaws + np.pi) % (2 * np.pi) - np.pi
    states = [(0.1 * k, 0.0, yaw) for k, yaw in enumerate(wrapped)]
    way, _ = found_way((0.8, 0.0, last), states, monkeypatch)
    assert way[:, 2] == pytest.approx(yaws)
