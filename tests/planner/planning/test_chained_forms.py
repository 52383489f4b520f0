"""Chained forms: found or declared, exact at every distance."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from planner.errors import PlannerError
from planner.extension.extended import extend
from planner.planning import chained_forms
from planner.planning.chained_forms import ChainedForm, FlatOutputs, chained_form
from planner.planning.rollouts import play, rollout
from planner.planning.shooting import steer
from planner.systems.fields import compile_fields, sample_configurations
from planner.systems.strata import StratifiedSystem
from tests.systems import X, Y, chained, hexapod


def trailers(number, length=1):
    return shipped_system("car-trailers", {"trailers": number, "length": length})


@pytest.fixture(scope="module")
def two():
    problem = trailers(2)
    return chained_form(problem.system, problem.flat)


@pytest.mark.parametrize("number", [1, 2])
def test_coordinates_move_as_the_chained_form_says(number):
    problem = trailers(number, 0.7)
    form = chained_form(problem.system, problem.flat)
    size = len(form.coordinates)
    state, z = form.system.state, sp.Matrix(form.coordinates)
    moved = [z.jacobian(state) * f for f in form.system.fields.values()]
    points = 0.5 * sample_configurations(size)
    rates = compile_fields(moved, state).values(points)  # (k, size, 2)
    for x, rate in zip(points, rates, strict=True):
        at = form.at(x)
        ahead = [1, 0, *at[1:-1]]
        turn = [0, 1, *[0] * (size - 2)]
        scale = 1 + np.abs(at).max()
        assert rate / scale == pytest.approx(
            np.transpose([ahead, turn]) / scale, abs=1e-12
        )


@pytest.mark.parametrize("sideways", [0.01, 1.0])
def test_two_trailers_are_parked_in_one_plan(two, sideways):
    goal = np.zeros(6)
    goal[1] = sideways
    planned = two.plan(np.zeros(6), goal)
    assert len(planned.flows) == 33
    assert rollout(planned)[-1] == pytest.approx(goal, abs=1e-11)  # integration


def test_any_two_configurations_of_the_chart_are_joined(two):
    rng = np.random.default_rng(3)
    start, goal = 0.4 * rng.uniform(-1, 1, (2, 6))
    planned = two.plan(start, goal, segments=2)
    assert rollout(planned)[-1] == pytest.approx(goal, abs=1e-9)
    first = play(two.system, planned.flows[: planned.segment_ends[0]], start)[-1]
    assert planned.nominal[1] == pytest.approx(first, abs=1e-12)
    middle = (two.at(start) + two.at(goal)) / 2
    assert two.at(planned.nominal[1]) == pytest.approx(middle, abs=1e-9)


@pytest.mark.full
def test_three_trailers_are_parked_in_one_plan():
    problem = trailers(3)
    goal = np.zeros(7)
    goal[1] = 0.5
    planned = chained_form(problem.system, problem.flat).plan(np.zeros(7), goal)
    assert rollout(planned)[-1] == pytest.approx(goal, abs=1e-9)


def test_combined_fields_only_combine_the_system_s_own(two):
    own = compile_fields(list(trailers(2).system.fields.values()), two.system.state)
    new = compile_fields(list(two.system.fields.values()), two.system.state)
    for x in 0.5 * sample_configurations(6):
        assert np.linalg.matrix_rank(np.hstack([own(x), new(x)]), tol=1e-9) == 2


@pytest.mark.parametrize("name", ["unicycle", "car", "chained"])
def test_flat_outputs_among_the_coordinates_are_found(name):
    problem = shipped_system(name)
    form = chained_form(problem.system)
    goal = problem.states[1]
    planned = form.plan(problem.states[0], goal)
    assert rollout(planned)[-1] == pytest.approx(goal, abs=1e-11)


def test_chained_forms_are_their_own():
    form = chained_form(chained(5))
    assert form.at([1, 2, 3, 4, 5]) == pytest.approx([1, 2, 3, 4, 5])


def test_shots_that_stall_fall_back_to_aiming():
    problem = trailers(2)
    extended = extend(problem.system, problem.elements)
    goal = np.zeros(6)
    goal[1] = 1e-3
    steered = steer(extended, np.zeros(6), goal, problem.execution)
    assert len(steered.plan.flows) == 165
    assert steered.critical_step < 1e-5
    assert rollout(steered.plan)[-1] == pytest.approx(goal, abs=1e-9)


def test_systems_without_a_chained_form_are_refused():
    with pytest.raises(PlannerError, match="has 6 fields; a chained form has two"):
        chained_form(hexapod())
    with pytest.raises(PlannerError, match="no two coordinates are flat outputs"):
        chained_form(shipped_system("engel").system)
    flat = StratifiedSystem((X, Y), {"0": {"f": [1, 0], "g": [1, 0]}}, "0")
    with pytest.raises(PlannerError, match="no two coordinates"):
        chained_form(flat)


@pytest.mark.parametrize(
    ("outputs", "message"),
    [
        ({"along": X, "across": X}, "are not flat outputs"),
        ({"along": X * Y, "across": Y, "rate": X}, "is not the rate that the fields"),
        ({"along": sp.Symbol("phi"), "across": Y}, "are not flat outputs"),
    ],
)
def test_outputs_that_are_not_flat_are_refused(outputs, message):
    with pytest.raises(PlannerError, match=message):
        chained_form(shipped_system("car").system, FlatOutputs(**outputs))


def test_a_start_at_a_singularity_is_refused_in_the_system_s_own_coordinates():
    unicycle = shipped_system("unicycle")
    form = chained_form(unicycle.system, FlatOutputs(Y, X))
    with pytest.raises(PlannerError, match="singular at x = 0, y = 0, theta = 0"):
        form.plan(np.zeros(3), [1, 1, 1])


def test_ends_that_a_singularity_separates_are_refused_in_the_same_coordinates():
    """A chart of a system that is not the same everywhere cannot be turned."""
    theta = sp.Symbol("theta")
    fields = {
        "drive": [sp.cos(theta) * sp.exp(X), sp.sin(theta) * sp.exp(X), 0],
        "turn": [0, 0, 1],
    }
    system = StratifiedSystem((X, Y, theta), {"0": fields}, "0")
    form = chained_form(system, FlatOutputs(X, Y))
    assert form.plane is None
    with pytest.raises(PlannerError, match="lead from x = 0, .* to .* theta = 3"):
        form.plan(np.zeros(3), [0.1, 0, 3])


RIGHT, FULL = np.pi / 2, pytest.mark.full
HEADINGS = [
    pytest.param((RIGHT, RIGHT), id="across"),
    pytest.param((1.6, 1.6), id="beyond", marks=FULL),
    pytest.param((2 * np.pi, 2 * np.pi), id="around", marks=FULL),
    pytest.param((0.0, RIGHT), id="a trailer across", marks=FULL),
    pytest.param((0.3, 3.2), id="a trailer folded"),
    pytest.param((3.0, -3.1), id="a trailer wound up", marks=FULL),
]


@pytest.fixture(scope="module")
def one():
    problem = trailers(1)
    return chained_form(problem.system, problem.flat)


@pytest.mark.parametrize("headings", HEADINGS)
def test_a_trailer_is_brought_to_any_heading(one, headings):
    goal = np.array([1.0, 1.0, *headings, 0.0])
    planned = one.plan(np.zeros(5), goal)
    assert rollout(planned)[-1] == pytest.approx(goal, abs=1e-9)
    assert planned.goal == pytest.approx(goal, abs=0)
    away = one.plan(goal, np.zeros(5))
    assert rollout(away)[-1] == pytest.approx(np.zeros(5), abs=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("headings", [(2.5, 2.0, 1.5), (-1.6, 1.0, 3.0)])
def test_two_trailers_are_brought_to_any_heading(two, headings):
    goal = np.array([0.5, -1.0, *headings, 0.2])
    planned = two.plan(np.zeros(6), goal)
    assert rollout(planned)[-1] == pytest.approx(goal, abs=1e-9)


@pytest.mark.full
def test_words_that_swing_too_far_for_a_chart_are_made_of_shorter_segments(two):
    goal = np.array([-1.824, -1.857, 0.094, -0.212, 2.621, 0.129])
    planned = two.plan(np.zeros(6), goal)
    assert rollout(planned)[-1] == pytest.approx(goal, abs=1e-9)


@pytest.mark.parametrize(
    ("missed", "tried", "taken"),
    [
        ([1e-12], 1, 1),  # as near as it gets
        ([1e-10, 1e-12], 2, 2),
        ([1e-4, 1e-6, 1e-10, 1e-12], 4, 4),
        ([1e-10, 2e-10], 2, 1),  # what ends farther away is left out
        ([1e-10, 1e-10], 2, 1),
        ([9e-10, 5e-10, 4e-10, 3e-10, 2e-10], 4, 4),  # no more than three times
    ],
)
def test_what_integration_misses_is_made_up_for_while_it_gets_nearer(
    missed, tried, taken, monkeypatch
):
    goal, asked, parts = np.ones(4), [], []

    def straight(start, goal, segments=1):
        asked.append((start.tolist(), segments))
        end = goal + [0.0, missed[len(asked) - 1], 0.0, 0.0]
        parts.append(SimpleNamespace(nominal=[start, end], segments=lambda: [[]]))
        return parts[-1]

    form = SimpleNamespace(system=None, _straight=straight)
    joined = lambda system, flows, start: (len(flows), start)  # noqa: E731
    monkeypatch.setattr(chained_forms, "_plan_of", joined)
    found = ChainedForm._corrected(form, np.zeros(4), goal, 5)
    if taken == 1:
        assert found is parts[0]
    else:
        assert found[0] == taken
        assert not found[1].any()
    assert asked[0] == ([0.0] * 4, 5)
    assert [start for start, _ in asked[1:]] == [
        part.nominal[-1].tolist() for part in parts[: tried - 1]
    ]
    assert len(asked) == tried


def test_what_is_still_missed_by_more_than_is_allowed_is_refused():
    form = SimpleNamespace(
        system=None,
        _straight=lambda start, goal, segments=1: SimpleNamespace(
            nominal=[goal + 1e-8]
        ),
        _separated=lambda start, goal: PlannerError("apart"),
    )
    with pytest.raises(PlannerError, match="apart"):
        ChainedForm._corrected(form, np.zeros(4), np.ones(4), 1)


def test_charts_are_those_of_the_same_system_turned(two):
    """The plan for a turned start and goal is the plan turned."""
    plane, goal = two.plane, np.array([1.0, 0.5, 0.3, 0.2, 0.1, 0.0])
    assert plane.headings == (2, 3, 4)
    turned = two.plan(plane.turned(np.zeros(6), 2.0), plane.turned(goal, 2.0))
    assert rollout(turned)[-1] == pytest.approx(plane.turned(goal, 2.0), abs=1e-9)
    assert [f.field for f in turned.flows][:2] != ["ahead", "turn"]


@pytest.mark.parametrize("number", [1, 2, 3])
def test_rates_that_are_not_declared_are_derived_in_short(number):
    problem = trailers(number)
    outputs = FlatOutputs(problem.flat.along, problem.flat.across)
    form = chained_form(problem.system, outputs)
    last = problem.system.state[2 + number]
    assert form.coordinates[-2].equals(sp.tan(last))
    assert sum(map(sp.count_ops, form.coordinates)) < 20_000  # measured: 12,000


def test_a_way_in_takes_half_as_long_at_twice_the_speed(one):
    """Its steps are angles of the headings, not times."""
    x, system = np.array([0.0, 0.0, 0.3, 3.2, 0.0]), one.plane.system
    fields = dict(system.fields)
    fields[one.plane.drive] = 2 * fields[one.plane.drive]
    quick = replace(one.plane, system=replace(system, strata={system.bottom: fields}))
    (slow, end), (fast, same_end) = one.plane.way_in(x), quick.way_in(x)
    scales = [2 if flow.field == one.plane.drive else 1 for flow in fast]
    durations = [flow.duration * k for flow, k in zip(fast, scales, strict=True)]
    assert durations == pytest.approx([flow.duration for flow in slow])
    assert same_end == pytest.approx(end)
