"""The shipped systems, each under one contract."""

import numpy as np
import pytest
import sympy as sp

from models.errors import ProblemError
from models.library import shipped_robots
from models.systems.catalogue import SYSTEMS, shipped_system
from planner.controllability.gaits import gait_controllability
from planner.execution.execution import Execution
from planner.extension.bracket_fields import hall_fields
from planner.extension.choice import choose_elements
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.rollouts import rollout
from planner.planning.shooting import steer
from planner.systems.elements import leaves, parse_names
from sim.scenarios.file import shipped_scenarios

NILPOTENT = {"finger-gaiting", "heisenberg", "brockett", "engel", "chained"}
SMOOTH = [name for name in SYSTEMS if len(shipped_system(name).system.strata) == 1]
EXACT = 1e-9  # what a nilpotent plan promises; rounding is far below


@pytest.fixture(scope="module", params=SYSTEMS)
def problem(request):
    return shipped_system(request.param)


@pytest.fixture(scope="module")
def compiled(problem):
    return extend(problem.system, problem.elements)


def highest_degree(names):
    return max(len(leaves(parse_names(name))) for name in names)


def degrees_of_the_algebra(problem, compiled):
    """Degrees of the brackets that remain, one degree beyond what is steered with."""
    beyond = highest_degree(problem.elements) + 1
    return highest_degree(
        hall_fields(problem.system, compiled.steering.hall.generators, beyond).names
    )


@pytest.mark.parametrize("name", SYSTEMS)
def test_name_is_the_registry_s_and_no_robot_s_or_scenario_s(name):
    assert shipped_system(name).name == name
    assert name not in (*shipped_robots(), *shipped_scenarios())


def test_gait_is_controllable(problem):
    report = gait_controllability(problem.system, problem.gait, problem.states[0])
    assert report.controllable, report


def test_algebra_ends_for_the_nilpotent_and_for_no_other(problem, compiled):
    ends = degrees_of_the_algebra(problem, compiled) <= highest_degree(problem.elements)
    assert ends == (problem.name in NILPOTENT)


def test_elements_chosen_automatically_are_of_no_higher_degree(problem):
    chosen = choose_elements(problem.system, problem.states).elements
    assert highest_degree(chosen) <= highest_degree(problem.elements)


@pytest.mark.parametrize("name", sorted(NILPOTENT))
def test_nilpotent_plan_meets_its_goal(name):
    problem = shipped_system(name)
    planned = plan(
        problem.system,
        problem.path,
        problem.segments,
        problem.elements,
        execution=Execution(stance=problem.stance, limits=problem.limits),
    )
    assert np.linalg.norm(rollout(planned)[-1] - problem.states[1]) < EXACT


@pytest.mark.parametrize("name", sorted(SYSTEMS.keys() - NILPOTENT))
def test_shots_halve_the_distance_to_a_goal_close_enough(name):
    problem = shipped_system(name)
    start, goal = problem.states
    near = start + 1e-3 * (goal - start)
    compiled = extend(problem.system, problem.elements)
    steered = steer(compiled, start, near, problem.execution, tolerance=1e-12)
    ratios = np.divide(steered.distances[1:], steered.distances[:-1])
    assert ratios.max() <= 0.5
    assert np.linalg.norm(rollout(steered.plan)[-1] - near) <= 1e-12


@pytest.mark.parametrize("name", sorted(SYSTEMS.keys() - NILPOTENT))
def test_more_segments_end_nearer(name):
    problem = shipped_system(name)
    compiled = extend(problem.system, problem.elements)

    def miss(segments, words):
        execution = Execution(coordinates=words)
        end = rollout(plan(compiled, problem.path, segments, execution=execution))[-1]
        return np.linalg.norm(end - problem.states[1])

    few, many = (miss(n * problem.segments, "backward") for n in (1, 4))
    assert many < few / 1.5  # it falls as 1 / n^(1/3) or faster, and 4^(1/3) is 1.59
    assert miss(problem.segments, "fewest") <= few * (1 + 1e-9)


@pytest.mark.parametrize("name", SMOOTH)
def test_verdict_on_a_smooth_system_is_that_of_chow(name):
    problem = shipped_system(name)
    state = sp.Matrix(problem.system.state)
    first, second = (sp.Matrix(f) for f in problem.system.fields.values())
    columns, newest = [first, second], second
    while len(columns) < len(state):
        newest = newest.jacobian(state) * first - first.jacobian(state) * newest
        columns.append(newest)
    at_start = sp.Matrix.hstack(*columns).subs(
        dict(zip(state, problem.states[0], strict=True))
    )
    assert at_start.rank() == len(state)
    report = gait_controllability(problem.system, problem.gait, problem.states[0])
    assert report.filtration == report.closure == len(state)


@pytest.mark.parametrize("name", SMOOTH)
def test_one_field_alone_reaches_one_direction(name):
    problem = shipped_system(name)
    (stratum,) = problem.system.strata
    fields = dict([*problem.system.strata[stratum].items()][:1])
    alone = type(problem.system)(problem.system.state, {stratum: fields}, stratum)
    report = gait_controllability(alone, problem.gait, problem.states[0])
    assert (report.controllable, report.rank, report.conclusive) == (False, 1, True)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("paper-hexapod", {"stride": 0.4, "yaw_gain": 0.7}),
        ("paper-hexapod", {"stride_2": 1.3, "yaw_gain_2": 0.6}),
        ("biped", {"hip": 0.2, "heights": False}),
        ("quadruped-crawl", {"length": 1, "width": 3}),
        ("octopod-pairs", {"heights": False}),
        ("hexapod-trailer", {"length": 2}),
        ("finger-gaiting", {"fingers": 5, "reach": 0.5}),
        ("car", {"length": 0.25}),
        ("car-trailers", {"trailers": 2}),
        ("chained", {"size": 8}),
    ],
)
def test_gait_is_controllable_with_other_parameters(name, values):
    problem = shipped_system(name, values)
    assert gait_controllability(
        problem.system, problem.gait, problem.states[0]
    ).controllable


def test_foot_heights_change_no_plan_of_the_hexapod():
    plans = []
    for heights in (True, False):
        problem = shipped_system("paper-hexapod", {"heights": heights})
        plans.append(plan(problem.system, problem.path, 4, problem.elements))
    assert plans[0].flows == plans[1].flows


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("centipede", {}, "system 'centipede' is unknown; there are paper-hexapod, "),
        (
            "car",
            {"lenght": 1},
            "parameters of car: lenght is unknown; .* 'length'",
        ),
        ("engel", {"size": 4}, "parameters of engel: size is unknown; it has none"),
        ("car", {"length": "long"}, "length is 'long'; give a number"),
        ("biped", {"heights": 1}, "heights is 1; give true or false"),
        ("chained", {"size": 4.5}, "size is 4.5; give a whole number"),
        ("chained", {"size": 2}, "size is 2; a chain has 3 to 8"),
        ("chained", {"size": True}, "size is True; give a whole number"),
        ("car-trailers", {"trailers": 0}, "trailers is 0; give 1 to 3"),
        ("finger-gaiting", {"fingers": 1}, "fingers is 1; 2 to 9"),
        (
            "car",
            {"length": 0},
            "field drive of S0 has .*zoo.*, no real number",
        ),
        ("biped", {"hip": 1e300}, r"g1_1 of S1 has .*e\+300, no real number below"),
        ("car", {"length": float("nan")}, "length must be a number, got nan"),
    ],
)
def test_impossible_parameters_are_refused(name, values, message):
    with pytest.raises(ProblemError, match=message):
        shipped_system(name, values)


def test_a_chained_form_goes_a_unit_along_its_last_coordinate():
    assert shipped_system("chained", {"size": 4}).goal == {"x4": 1}
