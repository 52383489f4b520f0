"""Flows integrated all at once end where they end one by one."""

import numpy as np
import pytest

from models.systems.catalogue import SYSTEMS, shipped_system
from planner.planning.rollouts import Level, batched, levels
from planner.systems.flows import Flow, flow_map
from planner.systems.strata import StratifiedSystem


def one_by_one(system, flows, start):
    states = [start]
    for flow in flows:
        states.append(flow_map(system, flow.field, states[-1], flow.duration))
    return np.array(states[1:])


def random_flows(system, count=30):
    rng = np.random.default_rng(3)
    names = rng.choice([str(name) for name in system.fields], count)
    spans = rng.uniform(-0.3, 0.3, count)
    return [
        Flow(system.stratum_of[name], str(name), float(span))
        for name, span in zip(names, spans, strict=True)
    ]


@pytest.mark.parametrize("name", sorted(SYSTEMS))
def test_ends_agree_wherever_there_is_an_order(name):
    system = shipped_system(name).system
    flows, start = random_flows(system), np.full(system.dimension, 0.1)
    found = batched(system, flows, start)
    if found is None:
        assert levels(system, tuple(system.fields)) is None
    else:
        assert found == pytest.approx(one_by_one(system, flows, start), abs=1e-11)


def test_a_body_is_integrated_after_its_heading_and_its_legs():
    system = shipped_system("biped").system
    first, second = levels(system, ("g1_1", "g2_2"))
    assert 2 in first.coordinates  # the heading
    assert second == Level([0, 1])


@pytest.mark.parametrize("trailers", [1, 2, 3])
def test_each_trailer_is_integrated_after_the_one_before_it(trailers):
    system = shipped_system("car-trailers", {"trailers": trailers}).system
    order = [level.coordinates for level in levels(system, ("drive", "steer"))]
    assert order[-trailers:] == [[3 + k] for k in range(trailers)]
    rng = np.random.default_rng(1)
    flows = [
        Flow("0", name, float(rng.uniform(-1, 1) * longest))
        for _ in range(40)
        for name, longest in (("drive", 1.0), ("steer", 0.1))
    ]
    start = np.full(system.dimension, 0.1)
    found = batched(system, flows, start)
    assert found == pytest.approx(one_by_one(system, flows, start), abs=1e-11)


def test_an_angle_that_is_turned_too_far_at_once_is_left_to_others():
    system = StratifiedSystem(["a"], {"0": {"f": ["2 + sin(a)"]}}, "0")
    assert levels(system, ("f",)) == [Level([0], angular=True)]
    short, long = ([Flow("0", "f", duration)] * 9 for duration in (0.3, 3.0))
    start = np.zeros(1)
    exact = one_by_one(system, short, start)
    assert batched(system, short, start) == pytest.approx(exact, abs=1e-11)
    assert batched(system, long, start) is None


def test_coordinates_that_drive_themselves_have_no_order():
    system = StratifiedSystem(["x"], {"0": {"f": ["x"]}}, "0")
    assert levels(system, ("f",)) is None
    assert batched(system, [Flow("0", "f", 0.5)] * 9, np.ones(1)) is None


def test_flows_beyond_all_numbers_are_left_to_others():
    system = StratifiedSystem(["x"], {"0": {"f": ["1"]}}, "0")
    assert batched(system, [Flow("0", "f", 1e308)] * 9, np.zeros(1)) is None


def test_flows_too_long_for_their_polynomials_are_left_to_others():
    system = StratifiedSystem(["x", "y"], {"0": {"f": [1, "sin(x)"]}}, "0")
    assert batched(system, [Flow("0", "f", 500.0)] * 9, np.zeros(2)) is None
