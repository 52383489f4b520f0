"""Elements chosen automatically: spanning, of low degree, with few switches."""

import numpy as np
import pytest

from models.systems.catalogue import shipped_system
from planner.errors import RankError, SingularConfigurationError
from planner.extension.choice import _candidates, choose_elements
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import rollout
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, METRES, PAPER, chained, flat_power, hexapod

HOME = [0.0] * 7


@pytest.mark.parametrize("gains", [{}, METRES])
def test_choice_for_the_hexapod_is_the_papers(gains):
    choice = choose_elements(hexapod(**gains, heights=True), HOME)
    assert choice.elements == PAPER


def test_without_fields_on_the_bottom_the_lifted_ones_are_chosen():
    robot = hexapod(heights=True)
    strata = {"12": {}, "1": robot.strata["1"], "2": robot.strata["2"]}
    lifted = StratifiedSystem(robot.state, strata, "12", robot.level_sets)
    assert set(choose_elements(lifted, HOME).elements) == set(LIFTED)


def test_brackets_are_of_the_lowest_degree_that_spans():
    assert choose_elements(chained(4), np.zeros(4)).elements == (
        "g1", "g2", "[g1,g2]", "[g1,[g1,g2]]",
    )  # fmt: skip


def in_units(system, units, gains):
    """The system with its coordinates in other units, and with stronger fields."""
    places = dict(zip(system.state, units, strict=True))
    longer = {symbol: unit * symbol for symbol, unit in places.items()}
    strata = {
        stratum: {
            name: [
                gains.get(name, 1) * entry.subs(longer) / unit
                for entry, unit in zip(field, units, strict=True)
            ]
            for name, field in fields.items()
        }
        for stratum, fields in system.strata.items()
    }
    bounds = {
        stratum: tuple(function.subs(longer) for function in functions)
        for stratum, functions in system.level_sets.items()
    }
    return StratifiedSystem(system.state, strata, system.bottom, bounds)


@pytest.mark.parametrize("factor", [1e-6, 1e-3, 1e3, 1e5])
@pytest.mark.parametrize("coordinates", [[0, 1], [2], [3]], ids=str)
def test_choice_does_not_depend_on_units(factor, coordinates):
    robot = hexapod(**METRES, heights=True)
    units = [factor if i in coordinates else 1 for i in range(7)]
    assert choose_elements(in_units(robot, units, {}), HOME).elements == PAPER
    gains = {"g12_1": factor}
    assert choose_elements(in_units(robot, [1] * 7, gains), HOME).elements == PAPER


def test_field_that_adds_nothing_here_may_be_needed_in_brackets():
    choice = choose_elements(flat_power(2), [0, 0])
    assert choice.elements == ("g1", "g2", "[g1,[g1,g2]]")
    assert "g2: degree 1, 0 contact switches, adds nothing but brackets" in str(choice)


def test_all_configurations_given_are_spanned():
    at = [[0, 0], [1, 0], [-2, 3]]
    matrices = extend(flat_power(1), choose_elements(flat_power(1), at).elements)
    assert np.linalg.matrix_rank(matrices.columns(at)).tolist() == [2, 2, 2]


def test_choice_is_explained_element_by_element():
    choice = choose_elements(hexapod(heights=True), HOME)
    assert choice.reasons[2].startswith("g1_2: degree 1, 2 contact switches, adds ")
    assert choice.reasons[4] == "[g12_1,g12_2]: degree 2, 0 contact switches, adds y"
    matrix = extend(hexapod(), PAPER).columns(np.zeros(5))
    lengths = np.linalg.norm(matrix, axis=0)
    assert choice.condition == pytest.approx(np.linalg.cond(matrix / lengths))


def test_fields_that_copy_one_another_are_chosen_once():
    twins = StratifiedSystem("x", {"0": {"a": [1]}, "1": {"b": [2]}}, "0")
    assert choose_elements(twins, [0]).elements == ("a",)


def test_plan_without_elements_chooses_them():
    path = line(np.zeros(5), [1, 1, 0, 0, 0])
    chosen, given = plan(hexapod(), path, 4), plan(hexapod(), path, 4, PAPER)
    assert chosen.elements == PAPER
    assert rollout(chosen)[-1] == pytest.approx(rollout(given)[-1], abs=1e-13)


def test_elements_are_chosen_once_for_each_system_and_path(monkeypatch):
    asked = []

    def choose(system, samples):
        asked.append(samples)
        return choose_elements(system, samples)

    monkeypatch.setattr("planner.planning.nominal.choose_elements", choose)
    system = hexapod()
    for goal in ([1, 1, 0, 0, 0], [1, 1, 0, 0, 0], [0, 1, 0, 0, 0]):
        plan(system, line(np.zeros(5), goal), 4)
    assert len(asked) == 2
    assert asked[1][-1] == pytest.approx([0, 1, 0, 0, 0])


def test_what_cannot_be_spanned_is_refused():
    with pytest.raises(RankError, match=r"rank 1 of 2 at \(0, 0\)"):
        choose_elements(flat_power(5), [0, 0], max_degree=3)


@pytest.mark.parametrize("weight", [0.01, 1.0, 100.0])
def test_a_direction_that_is_missing_is_the_same_in_any_metric(weight):
    fields = {"across": [1, 2, 0], "up": [0, 0, 1]}
    system = StratifiedSystem("x y z", {"0": fields}, "0", metric={"x": weight})
    with pytest.raises(RankError) as refused:
        choose_elements(system, [0, 0, 0], max_degree=2)
    assert refused.value.missing == ("x - 0.5 y",)


def test_misshapen_configurations_are_refused():
    with pytest.raises(ValueError, match=r"shape \(1, 3\), expected \(k, 5\)"):
        choose_elements(hexapod(), [0, 0, 0])


def test_degree_below_one_is_refused():
    with pytest.raises(ValueError, match="max_degree is 0; fields themselves have"):
        choose_elements(hexapod(), [0, 0, 0, 0, 0], max_degree=0)


def test_rank_is_refused_where_it_is_lost_and_not_where_units_hide_it():
    # a satellite in Euler angles, singular at theta = pi/2 and nowhere before
    roll = [1, 0, 0]
    pitch = ["sin(phi)*tan(theta)", "cos(phi)", "sin(phi)/cos(theta)"]
    satellite = StratifiedSystem(
        "phi theta psi", {"0": {"roll": roll, "pitch": pitch}}, "0"
    )
    way = line((0, 0, 0), (0.1, np.pi / 2, 0.3))
    for elements in (None, ["roll", "pitch", "[roll,pitch]"]):
        with pytest.raises(RankError, match=r"of 3 at \(0.1, 1.5708, 0.3\)"):
            plan(satellite, way, 1, elements)


def test_too_low_a_degree_is_told_from_too_few_fields():
    trailers = shipped_system("car-trailers", {"trailers": 3})
    with pytest.raises(RankError, match="brackets to degree 6 suffice: name them, or"):
        choose_elements(trailers.system, trailers.states[0])
    found = choose_elements(trailers.system, trailers.states[0], max_degree=6)
    assert len(found.elements) == 7


def test_a_trailer_across_behind_its_car_asks_for_one_degree_more():
    # in rational arithmetic: degree 5 for two trailers, and 6 with the first across
    trailers = shipped_system("car-trailers", {"trailers": 2}).system
    assert len(choose_elements(trailers, np.zeros(6), max_degree=5).elements) == 6
    across = np.array([0.0, 0.0, np.pi / 2, 0.0, 0.0, 0.0])
    with pytest.raises(RankError, match="brackets to degree 6 suffice"):
        choose_elements(trailers, across, max_degree=5)


def test_a_field_that_is_singular_at_one_place_is_refused_with_it():
    system = StratifiedSystem("x y", {"0": {"f": [1, 0], "g": ["1/x", 1]}}, "0")
    places = np.array([[1.0, 0.5], [0.0, 0.25], [2.0, 0.0]])
    field = system.fields["g"]
    with pytest.raises(SingularConfigurationError, match="g") as caught:
        _candidates(system, [("g", field)], places)
    assert "0.25" in str(caught.value)
