"""Clearances as expressions are those that shapely measures, from below."""

from dataclasses import replace

import numpy as np
import pytest

from sim.obstacles.clearance import surroundings
from sim.optimisation.judging import Judge
from sim.preparation.setup import prepare
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.file import load_scenario

ca = pytest.importorskip("casadi")
shapes = pytest.importorskip("sim.optimisation.clearances")

WALL = {"kind": "wall", "points": [[-0.4, 0.23], [0.4, 0.23]]}
BESIDE = {
    "path.goal": [0.014, 0.0, 0.0],
    "segments": 2,
    "path_tolerance": 0.03,
    "yaw_tolerance": 3.2,
    "optimise": "time",
    "hops": 0,
    "obstacles": [WALL],
}


@pytest.fixture(scope="module")
def passage():
    return prepare(load_scenario("corridor"))


def stage_on(stratum):
    return type("Stage", (), {"stratum": stratum})


@pytest.mark.parametrize("stratum", ["1", "2", "12"])
def test_outside_of_obstacles_they_are_exact_but_for_the_smoothing(passage, stratum):
    state = ca.SX.sym("state", 5)
    entries = [state[i] for i in range(5)]
    rows = shapes.clearances(passage, 0.0, 0.02)(stage_on(stratum), entries)
    found = ca.Function("least", [state], [ca.mmin(ca.vertcat(*rows))])
    rng, around = np.random.default_rng(0), surroundings(passage)
    along = passage.scenario.path.curve.at(rng.uniform(size=60))
    poses = along + rng.normal(size=(60, 3)) * [0.03, 0.03, 0.1]
    swing = rng.uniform(-0.45, 0.45, (60, 2))
    lift = np.array([g not in stratum for g in passage.robot.groups])
    lift = np.tile(lift * passage.limits.lift_angle, (60, 1))
    exact = around.clearances(around.outline.configurations(poses, swing, lift)).least
    free = exact > 0
    assert 20 < free.sum() < 60
    least = np.array([float(found(x)) for x in np.hstack([poses, swing])])
    over = exact - least
    assert over[free].min() > -1e-7  # [m], TINY's root apart
    assert over[free].max() < shapes.SMOOTHED * np.log(
        30
    )  # of as many distances at most
    assert least[~free].max() < 0.0


def test_only_sides_and_corners_that_are_in_reach_are_looked_at(passage):
    near = list(shapes.near_pieces(passage, 0.02))
    assert [len(piece.sides) for piece in near] == [1, 1, 2]
    assert [list(piece.corners) for piece in near[:2]] == [[], []]
    assert near[2].corners == [pytest.approx((0.14, 0.21))]


def test_parts_of_the_body_do_not_swing(passage):
    parts = shapes.moving_parts(passage, "1")
    fixed = [np.abs(p.terms[1:]).max() < 1e-9 for p in parts if p.leg == shapes.BODY]
    assert fixed
    assert all(fixed)


def test_parts_are_known_on_a_stratum_that_the_gait_leaves_out(passage):
    robot = passage.robot
    direct = replace(robot, card=replace(robot.card, gait=("1", "2", "1")))
    assert shapes.moving_parts(replace(passage, robot=direct), robot.card.bottom)


def test_a_plan_keeps_away_from_a_wall_that_it_would_come_too_close_to(monkeypatch):
    for name in ("CLOSELY", "PATIENT_FOR", "FINALISTS", "SOFT_GUESSES"):
        monkeypatch.setattr(f"planner.optimisation.windows.{name}", 1)
    free = prepare(load_scenario("line", BESIDE | {"min_clearance": -1.0}))
    close = ScenarioProblem(free).solve().plan
    asked = {"min_clearance": 0.02}
    setup = prepare(load_scenario("line", BESIDE | asked))
    judge = Judge(setup)
    assert judge.clearance_lack(list(close.segments())) > 0.002
    chosen = ScenarioProblem(setup).solve()
    assert chosen.fallback is None
    assert judge.clearance_lack(list(chosen.plan.segments())) == 0.0
