"""The critical step is where a plan stops halving the distance to its target."""

from math import inf

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.numerics import collocation
from planner.planning import critical_steps
from planner.planning.critical_steps import critical_step, least_critical_step
from planner.planning.shooting import shot_towards, steer
from planner.systems import flows
from planner.systems.strata import StratifiedSystem
from tests.systems import PAPER, chained, hexapod

ACCURACY = 1e-6  # relative, of the critical step

BACKWARD = Execution(coordinates="backward")


@pytest.mark.parametrize(
    "name", ["paper-hexapod", "unicycle", "car", "hexapod-trailer"]
)
def test_step_at_the_critical_length_halves_and_one_beyond_does_not(name):
    problem = shipped_system(name)
    extended = extend(problem.system, problem.elements)
    start, goal = problem.states
    critical = critical_step(extended, start, goal - start)
    direction = (goal - start) / np.linalg.norm(goal - start)
    ratios = []
    for length in (critical, critical * (1 + 2 * ACCURACY)):
        target = start + length * direction
        end = shot_towards(extended, start, target, BACKWARD).end
        ratios.append(np.linalg.norm(target - end) / length)
    assert ratios[0] <= 0.5 < ratios[1]
    assert ratios == pytest.approx([0.5, 0.5], abs=0.01)  # the ratio is continuous


def test_critical_step_does_not_depend_on_the_length_of_the_direction():
    extended = extend(hexapod(), PAPER)
    lengths = (1e-7, 1e-3, 50)
    found = [critical_step(extended, np.zeros(5), [0, t, 0, 0, 0]) for t in lengths]
    assert found == pytest.approx([found[-1]] * 3, rel=2 * ACCURACY)


def test_a_step_beyond_one_that_fails_is_not_critical():
    # of 3.41 along this ray 57 % is left, of 66 less than half again
    unicycle = shipped_system("unicycle").extended
    assert critical_step(unicycle, np.zeros(3), [0, 2.4, 8]) == pytest.approx(
        critical_step(unicycle, np.zeros(3), [0, 0.3, 1]), rel=2 * ACCURACY
    )
    assert critical_step(unicycle, np.zeros(3), [0, 2.4, 8]) < 3.41


def rays(extended, count, seed):
    """Random directions of length one in the bottom stratum."""
    bottom = extended.system.bottom_dimension
    drawn = np.random.default_rng(seed).normal(size=(count, bottom))
    drawn /= np.linalg.norm(drawn, axis=1)[:, None]
    return np.pad(drawn, ((0, 0), (0, extended.system.dimension - bottom)))


def left(extended, ray, length):
    start = np.zeros(extended.system.dimension)
    shot = shot_towards(extended, start, length * ray, BACKWARD)
    return np.linalg.norm(length * ray - shot.end) / length


@pytest.mark.parametrize("name", ["unicycle", "biped"])
def test_every_shorter_step_on_random_rays_is_halved(name):
    extended = shipped_system(name).extended
    start, random = np.zeros(extended.system.dimension), np.random.default_rng(1)
    least = least_critical_step(extended, start)
    for ray in rays(extended, 4, seed=1):
        found = critical_step(extended, start, ray)
        assert least <= found
        shorter = min(found, 1e3) * random.uniform(0.0, 1.0, 10) ** 0.5
        for length in (*shorter, least):
            assert left(extended, ray, length) <= 0.5


@pytest.mark.full
@pytest.mark.parametrize(
    "name",
    ["unicycle", "car", "biped", "paper-hexapod", "quadruped-crawl", "octopod-pairs",
     "hexapod-trailer", "car-trailers", "heisenberg", "engel"],
)  # fmt: skip
def test_no_step_on_a_hundred_rays_of_ten_systems_is_a_counterexample(name):
    extended = shipped_system(name).extended
    start, random = np.zeros(extended.system.dimension), np.random.default_rng(2)
    least = least_critical_step(extended, start)
    for ray in rays(extended, 100, seed=2):
        found = critical_step(extended, start, ray)
        assert least <= found * (1 + ACCURACY)
        for length in min(found, 1e2) * random.uniform(0.0, 1.0, 5) ** 0.5:
            assert left(extended, ray, length) <= 0.5


def test_critical_step_is_a_length_in_the_metric():
    in_millimetres = StratifiedSystem(
        "x y a",
        {"0": {"drive": ["1000*cos(a)", "1000*sin(a)", 0], "turn": [0, 0, 1]}},
        "0",
        metric={"x": 1e-3, "y": 1e-3},
    )
    unicycle = shipped_system("unicycle").extended
    for ray in ([0, 1, 0], [0.2, 0.3, 1]):
        scaled = np.multiply(ray, [1e3, 1e3, 1])
        found = critical_step(in_millimetres, np.zeros(3), scaled)
        assert found == pytest.approx(
            critical_step(unicycle, np.zeros(3), ray), rel=1e-4
        )


def test_unicycle_is_critical_where_its_rectangle_errs_by_half():
    # The word turn, drive, -turn, -drive of sides a = sqrt(y) ends at
    # (a (cos a - 1), a sin a), from which half of y is off at the critical step.
    problem = shipped_system("unicycle")
    extended = extend(problem.system, problem.elements)
    critical = critical_step(extended, np.zeros(3), [0, 1, 0])
    a = np.sqrt(critical)
    miss = np.hypot(a * (np.cos(a) - 1), a * np.sin(a) - critical)
    assert miss / critical == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("away", [1e3, -1e4, 1e6, 8e6])
def test_critical_steps_do_not_depend_on_where_the_plane_is_measured_from(away):
    # 4e-6 measured: the search's steps of 1e-6, and the rounding of coordinates
    unicycle = shipped_system("unicycle").system
    places = ((0.0, 0.0, 0.0), (away, 0.0, 0.0))
    critical = [critical_step(unicycle, at, (0, 1, 0)) for at in places]
    least = [least_critical_step(unicycle, at) for at in places]
    assert critical[1] == pytest.approx(critical[0], rel=1e-5)
    assert least[1] == pytest.approx(least[0], rel=1e-4)


def test_where_steps_are_lost_to_rounding_none_is_sought():
    unicycle = shipped_system("unicycle").system
    with pytest.raises(
        ValueError, match=r"path is at \(1e\+300, 0, 0\), where steps of"
    ):
        least_critical_step(unicycle, (1e300, 0, 0))


def test_steps_beyond_a_length_are_not_tried():
    problem = shipped_system("unicycle")
    critical = critical_step(problem.system, np.zeros(3), [0, 1, 0])
    near, far = (
        critical_step(problem.system, np.zeros(3), [0, critical / 3, 0], within=limit)
        for limit in (critical / 2, critical * 2)
    )
    assert near == inf
    assert critical_step(problem.system, np.zeros(3), [0, 1, 0], within=1e-20) == inf
    assert far == pytest.approx(critical, rel=2 * ACCURACY)


def test_nilpotent_systems_have_none():
    extended = extend(chained(4), ["g1", "g2", "[g1,g2]", "[g1,[g1,g2]]"])
    assert critical_step(extended, np.zeros(4), [0.1, 0, 0, 1]) == inf


def test_shorter_steps_are_not_cut_by_steer():
    extended = extend(hexapod(), PAPER)
    goal = np.array([10, 10, 3, 0, 0])
    critical = critical_step(extended, np.zeros(5), goal)
    assert (
        steer(
            extended,
            np.zeros(5),
            0.99 * critical * goal / np.linalg.norm(goal),
            BACKWARD,
        ).critical_step
        == inf
    )
    assert steer(extended, np.zeros(5), goal, BACKWARD).critical_step > critical


def test_bare_systems_have_their_elements_chosen():
    chosen = critical_step(hexapod(), np.zeros(5), [1, 1, 0, 0, 0])
    assert 1 < chosen < inf


def test_direction_without_length_is_refused():
    with pytest.raises(ValueError, match="direction has length 0; give one that"):
        critical_step(extend(hexapod(), PAPER), np.zeros(5), np.zeros(5))


def test_words_of_other_letters_follow_a_field_together(monkeypatch):
    """As many rounds as the longest of them has flows along it, and not all of both."""
    extended, followed = shipped_system("car").extended, []

    def counted(velocity, starts, *rest):
        followed.append(len(starts))
        return collocation.follow_all(velocity, starts, *rest)

    monkeypatch.setattr(flows, "follow_all", counted)
    steps = critical_steps._Steps(extended, np.zeros(4), None)
    steps.left(np.array([[0.0, 1e-3, 0.0, 0.0], [0.1, 0.2, 0.3, 0.1]]))
    assert followed == [2] * 5 + [1] * 6  # one has 5 flows along drive, the other 11


def test_directions_that_no_element_gives_have_no_step():
    x, y = sp.symbols("x y")
    system = StratifiedSystem((x, y), {"0": {"g": [1, 0]}}, "0")
    with pytest.raises(ValueError, match=r"shape \(3,\) at a .* of shape \(2,\); give"):
        critical_step(extend(system, ["g"]), np.zeros(2), [1, 0, 0])
    assert critical_step(extend(system, ["g"]), np.zeros(2), [0, 1]) == 0


def test_the_least_step_and_its_words_do_not_depend_on_units_or_on_other_choices():
    """Millimetres that count as such; alternating words are followed as backward."""
    fields = {"drive": ["1000*cos(a)", "1000*sin(a)", 0], "turn": [0, 0, 1]}
    units = {"x": 1e-3, "y": 1e-3}
    car = StratifiedSystem("x y a", {"0": fields}, "0", metric=units)
    assert least_critical_step(car, np.zeros(3)) == pytest.approx(0.71436, rel=1e-3)
    for choice, order in (
        ("symmetric", "backward"), ("backward", "backward"), ("forward", "forward"),
    ):  # fmt: skip
        steps = critical_steps._Steps(car, np.zeros(3), Execution(coordinates=choice))
        assert steps.order == order


def test_rays_keep_to_a_stratum_that_couples_coordinates_whatever_they_count():
    """A car with z = x, of which x and z together count as x alone does otherwise."""
    fields = {"drive": ["cos(a)", "sin(a)", 0, "cos(a)"], "turn": [0, 0, 1, 0]}
    x, z = sp.symbols("x z")
    metric = {"x": 0.6, "z": 0.8}
    tied = StratifiedSystem("x y a z", {"0": fields}, "0", {"0": [z - x]}, metric)
    assert least_critical_step(tied, np.zeros(4)) == pytest.approx(0.71436, rel=1e-3)
