"""Motions of the plane: a vehicle that is turned and moved does all as before."""

import numpy as np
import pytest

from models.systems.catalogue import shipped_system
from planner.planning.chained_forms import chained_form

X = np.array([0.4, -0.3, 0.5, 0.2, 0.1])  # x, y, headings of car and trailer, steering


@pytest.fixture(scope="module")
def plane():
    problem = shipped_system("car-trailers", {"trailers": 1, "length": 1})
    return chained_form(problem.system, problem.flat).plane


def rotated(place, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin], [sin, cos]]) @ place


def test_turns_add_up_and_end_where_they_began(plane):
    twice = plane.turned(plane.turned(X, 0.7), 0.4)
    assert twice == pytest.approx(plane.turned(X, 1.1))
    assert plane.turned(plane.turned(X, 2.0), -2.0) == pytest.approx(X)
    assert plane.turned(X, 0.0).tolist() == X.tolist()


@pytest.mark.parametrize("angle", [0.7, -2.0, 3.0])
def test_place_and_direction_turn_along(plane, angle):
    turned = plane.turned(X, angle)
    assert plane.at(turned) == pytest.approx(rotated(plane.at(X), angle))
    assert plane.direction(turned) == pytest.approx(plane.direction(X) + angle)


@pytest.mark.parametrize("turns", [-2, 0, 1])
def test_the_direction_counts_whole_turns_as_the_headings_do(plane, turns):
    """Its mean is of all headings, so they wind up together."""
    wound = X.copy()
    wound[list(plane.headings)] += 2 * np.pi * turns
    assert plane.direction(wound) == pytest.approx(
        plane.direction(X) + 2 * np.pi * turns
    )


def test_an_aligned_vehicle_has_its_outputs_at_the_place_and_moves_ahead(plane):
    place = np.array([0.3, -1.2])
    x = plane.aligned(place, 0.9)
    assert plane.at(x) == pytest.approx(place)
    assert x[list(plane.headings)] == pytest.approx([0.9, 0.9])
    assert x[plane.steered] == 0.0
    assert plane.direction(x) == pytest.approx(0.9)


def test_the_way_in_is_the_same_wherever_the_vehicle_stands_and_faces(plane):
    folded = np.array([0.0, 0.0, 0.3, 3.2, 0.0])
    (flows, end), turned = plane.way_in(folded), plane.turned(folded, 1.3)
    others, there = plane.way_in(turned)
    assert [flow.field for flow in others] == [flow.field for flow in flows]
    assert [flow.duration for flow in others] == pytest.approx(
        [flow.duration for flow in flows]
    )
    assert there == pytest.approx(plane.turned(end, 1.3))
    assert np.abs(np.diff(end[list(plane.headings)])).max() <= 0.8  # held by a chart


def test_headings_that_are_near_each_other_need_no_way_in(plane):
    flows, end = plane.way_in(X)
    assert flows == []
    assert end is X
