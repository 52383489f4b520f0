"""Plans: the five steps of Sec. 5.2, their accuracy, what they refuse."""

import numpy as np
import pytest

from planner.errors import (
    PlannerError,
    RankError,
    StratumError,
)
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.paths import ellipse, line, waypoints
from planner.planning.rollouts import play, rollout
from planner.planning.shooting import plan_step
from planner.systems.fields import NumericField
from planner.systems.flows import contact_switches
from planner.systems.strata import StratifiedSystem
from tests.systems import (
    LIFTED,
    LIFTS,
    PAPER,
    chained,
    flat_power,
    heisenberg,
    hexapod,
    with_lifts,
)

ROUNDING = 1e-12
AT_REST = np.zeros(5)
DIAGONALLY = line(AT_REST, [1, 1, 0, 0, 0])


@pytest.fixture(scope="module")
def paper():
    return extend(hexapod(), PAPER)


def miss(extended, path, segments, **options):
    planned = plan(extended, path, segments, execution=Execution(**options))
    return np.linalg.norm(rollout(planned)[-1] - planned.goal)


def test_plan_ends_in_the_stratum_it_started_in(paper):
    planned = plan(paper, DIAGONALLY, 4)
    assert (planned.depart, planned.arrive) == ("12", "12")
    robot = hexapod(heights=True)
    lifted = with_lifts(planned.flows, 0.1, LIFTS)
    end = play(robot, lifted, np.zeros(7))[-1]
    assert end[5:] == pytest.approx([0, 0], abs=ROUNDING)


@pytest.mark.parametrize("size", [3, 4, 5])
def test_nilpotent_systems_are_steered_exactly(size):
    brackets = ["[g1,g2]", "[g1,[g1,g2]]", "[g1,[g1,[g1,g2]]]"][: size - 2]
    extended = extend(chained(size), ["g1", "g2", *brackets])
    goal = np.array([0.4, -0.7, 0.9, -0.3, 0.2])[:size]
    for coordinates in ("backward", "forward"):
        assert miss(extended, line(goal * 0, goal), 1, coordinates=coordinates) < 1e-9


def test_heisenberg_is_steered_exactly_along_any_path():
    extended = extend(heisenberg(), ["g1", "g2", "[g1,g2]"])
    path = ellipse([0.1, 0.2, 0.3], (0.5, 0.3))
    assert miss(extended, path, 3) < 1e-9


def test_higher_truncation_than_the_selection_needs_changes_nothing():
    # in a chained form of four, [g2,[g1,g2]] vanishes as a field and is left out
    extended = extend(chained(4), ["g1", "g2", "[g1,g2]", "[g1,[g1,g2]]"])
    assert extended.steering.basis == extended.elements


def test_open_loop_error_falls_as_one_over_the_number_of_segments(paper):
    errors = [n * miss(paper, DIAGONALLY, n, coordinates="backward") for n in (64, 128)]
    assert errors == pytest.approx([0.042, 0.042], rel=0.01)


def test_replanned_error_falls_as_its_square(paper):
    def replanned(segments):
        here = AT_REST
        for k in range(1, segments + 1):
            target = np.array([k / segments, k / segments, 0, 0, 0])
            here = rollout(plan_step(paper, here, target, Execution()).plan)[-1]
        return np.linalg.norm(here - [1, 1, 0, 0, 0])

    errors = [n**2 * replanned(n) for n in (16, 32)]
    # the next order is a fraction 1/n of it
    assert errors[1] == pytest.approx(errors[0], rel=0.1)


def test_segments_meet_their_ends_in_the_extended_system(paper):
    # the collocated inputs integrate to the path's own displacement
    path = ellipse(AT_REST, (0.3, 0.2))
    planned = plan(paper, path, 5)
    s = np.linspace(0, 1, 6)
    moved = np.diff(path.at(s), axis=0)
    assert planned.hall_coordinates[:, 0] + planned.hall_coordinates[:, 1] == (
        pytest.approx(moved[:, 0], abs=ROUNDING)
    )


def test_segment_ends_divide_the_flows(paper):
    planned = plan(paper, DIAGONALLY, 4)
    assert planned.segment_ends[-1] == len(planned.flows)
    assert sum(planned.segments(), ()) == planned.flows
    assert planned.inputs.shape[::2] == (4, 5)
    assert planned.hall_coordinates.shape == (4, len(planned.basis))


@pytest.mark.parametrize("stance", ["paper", "centred"])
def test_path_of_zero_length_is_an_empty_plan(paper, stance):
    planned = plan(paper, line(AT_REST, AT_REST), 3, execution=Execution(stance=stance))
    assert planned.flows == ()
    assert planned.contact_switches == 0
    assert rollout(planned).tolist() == [AT_REST.tolist()]


def test_segment_of_zero_length_is_empty_even_where_rank_is_lost():
    pinched = extend(flat_power(1), ["g1", "g2"])
    waiting = plan(pinched, lambda s: [0.0, 0.0], 2)
    assert waiting.flows == ()


def test_any_function_of_s_is_a_path(paper):
    planned = plan(paper, lambda s: [s, s, 0, 0, 0], 3)
    assert planned.flows == plan(paper, DIAGONALLY, 3).flows


def test_corners_are_met_by_segments(paper):
    corner = waypoints([AT_REST, [0.2, 0, 0, 0, 0], [0.2, 0.4, 0, 0, 0]])
    planned = plan(paper, corner, 4)
    assert miss(paper, corner, 64) < 0.01
    # no segment turns the corner: each goes along x or along y alone
    goals = planned.inputs.mean(axis=1) @ paper.columns(AT_REST).T
    assert np.abs(goals[:, :2]).min(axis=1) == pytest.approx(np.zeros(4), abs=ROUNDING)


def test_segments_too_few_to_meet_the_corners_are_refused(paper):
    there = [0.2, 0, 0, 0, 0]
    back_and_forth = waypoints([AT_REST, there, AT_REST, there])
    assert len(plan(paper, back_and_forth, 3).segment_ends) == 3
    with pytest.raises(PlannerError, match="cuts corners .* has 2; plan at least 3 se"):
        plan(paper, back_and_forth, 2)


def test_start_and_goal_may_be_in_different_strata():
    robot = extend(hexapod(), LIFTED)
    path = line(AT_REST, [0.1, 0, 0, 0, 0])
    free = plan(robot, path, 1)
    held = plan(robot, path, 1, execution=Execution(depart="1", arrive="1"))
    assert rollout(held)[-1][:3] == pytest.approx(rollout(free)[-1][:3], abs=ROUNDING)
    assert held.contact_switches == contact_switches(robot.system, held.flows, "1", "1")
    assert held.contact_switches == free.contact_switches - 2


def test_numeric_fields_are_steered_as_symbolic_ones(paper):
    def tripod(sign):
        return NumericField(
            lambda x: np.array([np.cos(x[2]), np.sin(x[2]), sign, sign > 0, sign < 0])
        )

    strata = {s: dict(fields) for s, fields in hexapod().strata.items()}
    strata["12"] = {"g12_1": tripod(1.0), "g12_2": tripod(-1.0)}
    numeric = StratifiedSystem(hexapod().state, strata, "12")
    end = rollout(plan(numeric, DIAGONALLY, 1, PAPER))[-1]
    # brackets by extrapolated differences
    assert end == pytest.approx(rollout(plan(paper, DIAGONALLY, 1))[-1], abs=1e-9)


@pytest.mark.parametrize(
    ("path", "segments", "message"),
    [
        (DIAGONALLY, 0, "segments is 0; a whole number from 1 to 100000"),
        (DIAGONALLY, True, "segments is True; a whole number"),
        (DIAGONALLY, 100_001, "segments is 100001; a whole number from 1 to 100000"),
        (DIAGONALLY, 2.5, "segments is 2.5; a whole number from 1 to 100000"),
        (lambda s: [s, s, 0], 1, r"path returns shape \(3,\), expected \(5,\): x, y"),
        (lambda s: [s, s, 0, 0, np.nan], 1, "path is not finite at s = 0"),
        ([0, 1], 1, r"path is \[0, 1\]; give a function"),
        (
            lambda s: [1e16 + s, s, 0, 0, 0],
            4,
            r"path is at \(1e\+16, 0, 0, 0, 0\), where steps of 2 are lost to "
            "rounding; measure from a nearer origin",
        ),
    ],
)
def test_unsound_requests_are_refused(paper, path, segments, message):
    with pytest.raises(ValueError, match=message):
        plan(paper, path, segments)


def test_path_off_the_bottom_stratum_is_refused():
    flying = line(np.zeros(7), [0.1, 0, 0, 0, 0, 0.05, 0])
    with pytest.raises(ValueError, match="path leaves S12 at s = 1, where height_1"):
        plan(hexapod(heights=True), flying, 1, LIFTED)


def test_elements_are_asked_for_once(paper):
    with pytest.raises(ValueError, match="elements are given twice"):
        plan(paper, DIAGONALLY, 1, PAPER)


@pytest.mark.parametrize(
    ("choice", "error", "message"),
    [
        ({"stance": "center"}, ValueError, "stance 'center' is unknown; .* centred"),
        (
            {"coordinates": "best"},
            ValueError,
            "'best' is unknown; .* fewest",
        ),
        ({"depart": "3"}, StratumError, "stratum '3' is unknown; there are 12, 1, 2"),
    ],
)
def test_unknown_choices_are_refused(paper, choice, error, message):
    with pytest.raises(error, match=message):
        plan(paper, DIAGONALLY, 1, execution=Execution(**choice))


@pytest.mark.parametrize("execution", ["paper", 3])
def test_what_is_no_execution_is_refused_in_a_sentence(paper, execution):
    said = f"execution is {execution!r}; give an Execution, or none"
    with pytest.raises(ValueError, match=said):
        plan(paper, DIAGONALLY, 1, execution=execution)


def test_rank_lost_on_the_way_is_refused_with_the_place():
    with pytest.raises(RankError, match=r"rank 1 of 2 at \(0, 0\)"):
        plan(flat_power(1), line([-1, 0], [1, 0]), 2, ["g1", "g2"])


def test_printed_plan_tells_strata_fields_and_durations(paper):
    text = str(plan(paper, line(AT_REST, [0.3, 0, 0, 0, 0]), 2))
    assert text.startswith("2 segments, ")
    assert "S12 " in text
    assert " g12_1" in text


def test_a_plan_that_misses_all_of_its_way_is_refused():
    drive = ["cos(a)", "sin(a)", "tan(b)", 0]
    car = StratifiedSystem("x y a b", {"0": {"d": drive, "s": [0, 0, 0, 1]}}, "0")
    elements = ["d", "s", "[d,s]", "[d,[d,s]]"]

    def parked(steering):
        return plan(car, line((0, 0, 0, steering), (0, 0.1, 0, steering)), 4, elements)

    with pytest.raises(PlannerError, match=r"misses 100 % .* at \(0, 0, 0, 1.5707\)"):
        parked(np.pi / 2 - 1e-4)
    assert parked(1.0).flows
