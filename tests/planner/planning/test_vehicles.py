"""Ways of vehicles in the plane: their steps, charts, and what has no such motions."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from planner.errors import PlannerError
from planner.planning import chained_forms, plane as planes
from planner.planning.chained_forms import chained_form
from planner.planning.plane import Plane
from planner.planning.rollouts import play
from planner.systems.fields import compile_fields
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

ALIGNED = 0.8  # [rad] between two headings of a vehicle that a chart holds well
STEERED = (0.0, 1.1, -1.1)  # values of the steered coordinate on the way to that

X = np.array([0.4, -0.3, 0.5, 0.2, 0.1])  # x, y, headings of car and trailer, steering


@pytest.fixture(scope="module")
def form():
    problem = shipped_system("car-trailers", {"trailers": 1, "length": 1})
    return chained_form(problem.system, problem.flat)


@pytest.fixture
def plane(form):
    return form.plane


@pytest.mark.parametrize("value", STEERED)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_step_is_driven_with_the_wheels_steered(plane, value, direction):
    steered = X.copy()
    steered[plane.steered] = value
    flow = Flow(plane.system.bottom, plane.drive, direction * plane._step)
    exact = play(plane.system, [flow], steered)[-1]
    (found,) = plane._driven(X[None], value, direction)
    assert found == pytest.approx(exact, abs=1e-6)
    assert found[plane.steered] == value


def test_steps_are_of_the_fourth_order(plane, monkeypatch):
    missed = []
    for substeps in (2, 4):
        monkeypatch.setattr(planes, "SUBSTEPS", substeps)
        (found,) = plane._driven(X[None], 1.1, 1.0)
        monkeypatch.setattr(planes, "SUBSTEPS", 64)
        (exact,) = plane._driven(X[None], 1.1, 1.0)
        missed.append(np.abs(found - exact).max())
    assert 2**3.5 < missed[0] / missed[1] < 2**4.7


def test_a_step_turns_the_fastest_heading_by_a_quarter_of_a_radian(plane):
    still = np.zeros((1, 5))
    still[0, plane.steered] = 1.1
    rates = plane.system.compiled(plane.drive).velocity(still[0])
    turned = np.abs(rates[list(plane.headings)]).max() * plane._step
    assert turned == pytest.approx(0.25)


@pytest.mark.parametrize("angle", [0.6, -1.9])
def test_fields_of_a_turned_chart_are_those_of_the_chart_turned(form, plane, angle):
    system, z = plane.chart(form.system, form.coordinates, angle)
    assert set(system.fields) == set(form.system.fields)
    back = plane.turned(X, -angle)
    for name, field in system.fields.items():
        own = compile_fields([sp.Matrix(field)], system.state).velocity(X)
        first = form.system.compiled(name).velocity(back)
        i, j = plane.place
        cos, sin = np.cos(angle), np.sin(angle)
        expected = first.copy()
        expected[[i, j]] = (
            cos * first[i] - sin * first[j],
            sin * first[i] + cos * first[j],
        )
        assert own == pytest.approx(expected)
    values = compile_fields([sp.Matrix(z)], system.state).velocity(X)
    assert values == pytest.approx(form.at(back))


@pytest.mark.parametrize(
    ("way", "names", "durations"),
    [
        ([], "s", [-0.1]),
        ([(0.1, 1.0), (0.1, 1.0)], "ds", [2.0, -0.1]),
        ([(0.1, 1.0), (0.1, -1.0)], "s", [-0.1]),
        ([(1.1, -1.0), (1.1, -1.0), (0.0, 1.0)], "sdsd", [1.0, -2.0, -1.1, 1.0]),
        ([(0.0, 1.0), (-1.1, 1.0)], "sdsds", [-0.1, 1.0, -1.1, 1.0, 1.1]),
    ],
)
def test_steps_with_the_wheels_alike_are_one_flow(plane, way, names, durations):
    flows, end = plane._followed(X, tuple(way), 1.0)
    words = {"s": plane.steer, "d": plane.drive}
    kept = [flow for flow in flows if flow.duration]
    assert [flow.field for flow in kept] == [words[name] for name in names]
    units = [1.0 if name == "s" else plane._step for name in names]
    assert [flow.duration for flow in kept] == pytest.approx(
        [d * u for d, u in zip(durations, units, strict=True)]
    )
    assert end == pytest.approx(play(plane.system, flows, X)[-1])
    assert end[plane.steered] == pytest.approx(0.0)


def test_steering_takes_as_long_as_its_rate_says(plane):
    half, _ = plane._followed(X, (), 0.5)
    whole, _ = plane._followed(X, (), 1.0)
    assert half[0].duration == pytest.approx(2 * whole[0].duration)


@pytest.mark.parametrize("apart", [ALIGNED, -ALIGNED, 0.0])
def test_a_vehicle_that_a_chart_holds_needs_no_way_in(plane, apart):
    x = X.copy()
    x[list(plane.headings)] = 0.0, apart
    assert plane.way_in(x)[0] == []
    x[plane.headings[1]] *= 1 + 1e-9
    assert (plane.way_in(x)[0] == []) == (apart == 0.0)


def test_wheels_that_are_steered_far_are_straightened_first(plane):
    x = X.copy()
    for steered, flows in ((ALIGNED, 0), (ALIGNED + 1e-9, 1), (-ALIGNED - 1e-9, 1)):
        x[plane.steered] = steered
        found, end = plane.way_in(x)
        assert len(found) == flows
        if flows:
            assert found[0].field == plane.steer
            assert end[plane.steered] == pytest.approx(0.0)


def test_a_way_that_is_too_long_is_not_looked_for(plane, monkeypatch):
    folded = np.array([0.0, 0.0, 0.3, 3.2, 0.0])
    monkeypatch.setattr(planes, "MOST_LAYERS", 1)
    with pytest.raises(PlannerError, match=r"no way was found to align .*0.3, 3.2"):
        plane.way_in(folded)


def vehicle(drive, steer=(0, 0, 0, 1), outputs="x y", names="x y a s"):
    system = StratifiedSystem(
        names, {"0": {"drive": list(drive), "steer": list(steer)}}, "0"
    )
    named = {s.name: s for s in system.state}
    pair = tuple(sp.sympify(text, locals=named) for text in outputs.split())
    return Plane.of(system, pair, "drive", "steer")


CAR = ["cos(a)", "sin(a)", "tan(s)", 0]


@pytest.mark.parametrize(
    "given",
    [
        {"drive": ["cos(a) + 0.01*x", "sin(a)", "tan(s)", 0]},  # it matters where
        {"drive": ["cos(a)", "sin(a)", "tan(s) + 0.001*a", 0]},  # and how it faces
        {"drive": ["cos(a)", "1.001*sin(a)", "tan(s)", 0]},
        {"drive": ["cos(2*a)", "sin(2*a)", "tan(s)", 0]},
        {"drive": CAR, "steer": (0, 0, 1, 1)},  # two coordinates are steered
        {"drive": CAR, "steer": (0, 0, 0, "1 + s**2")},  # at a rate that varies
        {"drive": CAR, "outputs": "x-2*cos(a) y"},  # which do not turn along
        {"drive": CAR, "outputs": "2*x y"},
        {"drive": CAR, "outputs": "a y"},
    ],
)
def test_what_is_not_the_same_all_over_the_plane_has_no_motions_of_it(given):
    assert vehicle(**given) is None


@pytest.mark.parametrize("outputs", ["x y", "x-2*cos(a) y-2*sin(a)"])
def test_a_car_is_the_same_wherever_it_stands_and_faces(outputs):
    found = vehicle(CAR, outputs=outputs)
    assert (found.place, found.headings, found.steered) == ((0, 1), (2,), 3)
    swapped = vehicle(["sin(a)", "cos(a)", "-tan(s)", 0])
    assert swapped is None  # its heading turns the other way


def test_a_plan_is_as_far_from_its_goal_as_its_end_is():
    ends = np.array([[0.0, 0.0], [5.0, 5.0], [1.0, -2.0]])
    planned = SimpleNamespace(nominal=ends)
    assert chained_forms._apart(planned, np.array([1.5, -1.0])) == 1.0
