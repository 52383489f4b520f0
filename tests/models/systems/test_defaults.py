"""Systems made without numbers are those of unit length that their pages describe."""

import inspect

import pytest

from models.systems.legged import (
    biped,
    finger_gaiting,
    hexapod_with_trailer,
    octopod,
    paper_hexapod,
    quadruped,
)
from models.systems.problem import Problem
from models.systems.smooth import car_with_trailers, chained

UNITS = [
    (paper_hexapod, {"stride": 1, "yaw_gain": 1, "heights": True}),
    (hexapod_with_trailer, {"length": 1, "heights": True}),
    (biped, {"hip": 1, "heights": True}),
    (quadruped, {"length": 2, "width": 1, "heights": True}),
    (octopod, {"length": 3, "width": 1, "heights": True}),
    (finger_gaiting, {"fingers": 3, "reach": 1, "span": 0.5}),
    (car_with_trailers, {"trailers": 1, "length": 1}),
    (chained, {"size": 5}),
]


@pytest.mark.parametrize(("make", "given"), UNITS)
def test_a_system_without_numbers_is_the_one_of_unit_lengths(make, given):
    assert set(given) <= set(inspect.signature(make).parameters)
    plain, explicit = make().system, make(**given).system
    assert plain.state == explicit.state
    assert plain.strata == explicit.strata
    assert make().segments == make(**given).segments


@pytest.mark.parametrize("make", [biped, quadruped, octopod])
def test_walkers_know_how_high_their_feet_are_unless_they_are_to_be_flat(make):
    def lifted(system):
        return [str(name) for name in system.state if str(name).startswith("height")]

    assert len(lifted(make().system)) >= 2
    assert lifted(make(heights=False).system) == []


def test_a_car_pulls_three_trailers_at_most():
    assert len(car_with_trailers(3).system.state) == 7  # x, y, phi, four headings
    with pytest.raises(ValueError, match="4"):
        car_with_trailers(4)


def test_a_plan_of_a_system_is_aimed_only_where_that_is_asked_for():
    problem = biped()
    plain, open_loop, aimed = (problem.plan(*how) for how in ((), (False,), (True,)))
    assert plain.flows == open_loop.flows
    assert plain.flows != aimed.flows


def test_a_problem_of_which_no_more_is_said_is_one_straight_line_in_any_order():
    system = quadruped().system
    gait = quadruped().gait
    plain = Problem(
        name="it", description="", system=system, gait=gait, elements=(), goal={"x": 1}
    )
    assert plain.segments == 1
    assert plain.open_loop.gait == ()
    assert plain.open_loop.stance == "paper"
