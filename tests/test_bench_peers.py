"""Peers: arcs that are the robot's own, an optimum that others confirm."""

import numpy as np
import pytest

from models.equations import equations
from models.robot import load
from planner.flows import flow_map
from sim import bench_peers
from sim.bench_peers import GOAL, Arcs
from sim.errors import UsageError


@pytest.fixture(scope="module")
def hexapod():
    return equations(load("hexapod"))


@pytest.fixture(scope="module")
def arcs(hexapod):
    stride, _, yaw_gain = hexapod.twists["g1_1"]
    return Arcs(stride, yaw_gain)


@pytest.mark.parametrize(("field", "side"), [("g1_1", 1), ("g2_2", -1)])
def test_arc_is_the_flow_of_a_loaded_swing(hexapod, arcs, field, side):
    pose = np.array([0.1, -0.2, 0.7])
    flown = flow_map(hexapod.system, field, [*pose, 0, 0, 0, 0], 0.9)[:3]
    # a flow is followed to the last digits
    assert arcs.after(pose, side, 0.9) == pytest.approx(flown, abs=1e-12)


def test_optimum_meets_the_goal_and_is_that_of_reeds_and_shepp(arcs):
    pytest.importorskip("casadi")
    pytest.importorskip("ompl")
    end, travel = bench_peers.MultipleShooting(arcs).once()
    _, shortest = bench_peers.reeds_shepp(arcs)
    assert arcs.error(end) < 1e-6  # what IPOPT's tolerance promises, and more
    # few arcs in place of a straight piece: measured 0.1 % longer
    assert shortest <= travel < 1.01 * shortest


def test_plan_in_shortest_words_is_near_the_optimum(hexapod, arcs):
    answers = {
        name: solve() for name, solve, _ in bench_peers.plans(hexapod, segments=4)
    }
    straight = np.hypot(*GOAL[:2]) / arcs.stride  # no way is shorter
    for end, travel in answers.values():
        assert arcs.error(end) < 0.01
        assert travel > straight
    printed, shortest, _ = (travel for _, travel in answers.values())
    assert shortest < 0.7 * printed  # measured: half


@pytest.mark.parametrize("missing", ["casadi", "ompl"])
def test_missing_extra_is_named(monkeypatch, missing):
    monkeypatch.setattr(
        bench_peers, "find_spec", lambda name: None if name == missing else object()
    )
    with pytest.raises(UsageError, match=rf"{missing} is missing: --peers; install"):
        next(bench_peers.peers())
