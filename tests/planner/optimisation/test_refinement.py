"""Violations between the points that are checked, and the margins that mend them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from planner.optimisation.constraints import Margins
from planner.optimisation.corridor import Tolerance
from planner.optimisation.program import Program
from planner.optimisation.refinement import Refinement, Violations
from planner.optimisation.task import Inequality
from planner.planning.rollouts import play
from planner.systems.flows import Flow
from tests.planner.optimisation.step import POSITION, STEP, YAW, optimised

FINE_STEPS = 12  # of a stage
GUARD = 1e-3  # further share of a tolerance, since larger margins move the plan

STROKES = np.array([0.3, -0.2, 0.4])
LOW = Inequality("room", lambda stage, state: [state[3] + 0.05, 1.0 - state[0]])
HIGH = Inequality("reach", lambda stage, state: [0.1 - state[4]])


def solved(first=0, start=None, **changes):
    """A task, and the motion of some strokes of it."""
    task = replace(optimised().task, **changes)
    start = STEP(0.0) if start is None else start
    guess = Program(task, STEP, 3, first).guess(STROKES, start, (0.0, 1.0))
    return task, guess


def motion(task, solution, k, count=FINE_STEPS):
    """States of the flows of a stage, played exactly, from its recoveries on."""
    stage, start = task.stage(solution.first + k), solution.states[k]
    pairs = zip(stage.recoveries, solution.recoveries[k], strict=False)
    flows = [Flow(stage.stratum, r.field, float(a)) for r, a in pairs]
    states = play(task.system, flows, start)[-1] if flows else start
    half = [flow._replace(duration=flow.duration / 2) for flow in flows]
    halfway = play(task.system, half, start)[-1]
    stroke = Flow(stage.stratum, stage.stroke, float(solution.strokes[k]))
    return start, halfway, play(task.system, [stroke], states, count)[1:]


@pytest.mark.parametrize("first", [0, 1])
def test_a_stage_is_checked_from_its_start_to_its_end(first):
    task, solution = solved(first, inequalities=(LOW, HIGH))
    refinement = Refinement(task, STEP)
    for k in range(3):
        states, lacks = refinement._checked(solution, k)
        start, halfway, exact = motion(task, solution, k)
        assert states == pytest.approx(exact[:, task.moved], abs=1e-6)
        every = [start, halfway, *exact]
        for lack, inequality in zip(lacks, task.inequalities, strict=True):
            least = min(min(inequality.expressions(None, x)) for x in every)
            assert lack == pytest.approx(max(0.0, -least), abs=1e-6)
    assert max(refinement._checked(solution, k)[1].max() for k in range(3)) > 0.01


def test_the_width_of_a_stage_is_its_largest_deviation():
    task, solution = solved()
    refinement = Refinement(task, STEP)
    parts = [refinement._checked(solution, k)[0] for k in range(3)]
    expected = []
    for k, part in enumerate(parts):
        shares = np.arange(1, FINE_STEPS + 1) / FINE_STEPS
        begin, end = solution.places[k : k + 2]
        off = part[:, :2] - STEP.at(begin + (end - begin) * shares)[:, :2]
        position = np.linalg.norm(off, axis=1).max() / POSITION
        expected.append(
            max(position, np.abs(part[:, 2]).max() / YAW)
        )  # the path's is 0
    assert refinement._widths([solution], parts) == pytest.approx(expected)
    alone = replace(task, tolerances=(Tolerance((0, 1), 9.0), Tolerance((2,), 1e-3)))
    turned = [np.abs(part[:, 2]).max() / 1e-3 for part in parts]
    found = Refinement(alone, STEP)._widths([solution], parts)
    assert found == pytest.approx(turned)


class Known(Refinement):
    """A refinement of stages whose widths and violations are known."""

    def _checked(self, solution, number):
        return None, np.array(self.path[0][solution.first + number])

    def _widths(self, solutions, parts):
        return np.array(self.path[1])


def enlarged(widths, lacks, violations, before=None):
    """Margins of two solutions, of one stage and of two."""
    one, two = (
        SimpleNamespace(first=first, strokes=np.zeros(count))
        for first, count in ((0, 1), (1, 2))
    )
    task = SimpleNamespace(inequalities=("a", "b"))
    none = [Margins.none(task, 1), Margins.none(task, 2)]
    known = Known(task, (lacks, widths))
    return known.enlarged(before or none, [one, two], violations), none


QUIET = np.zeros((3, 2))


def test_what_is_not_violated_needs_no_larger_margins():
    found, none = enlarged([0.9] * 3, QUIET, Violations(1.0, np.zeros(2)))
    assert [a is b for a, b in zip(found, none, strict=True)] == [True, True]


def test_only_the_solution_at_fault_gets_larger_margins():
    found, none = enlarged([0.5, 1.2, 1.0], QUIET, Violations(1.2, np.zeros(2)))
    assert found[0] is none[0]
    assert found[1].shares == pytest.approx([1 / (1.2 + GUARD), 1.0])
    again, _ = enlarged([1, 1.1, 1], QUIET, Violations(1.1, np.zeros(2)), found)
    assert again[1].shares[0] == pytest.approx(1 / (1.2 + GUARD) / (1.1 + GUARD))


@pytest.mark.parametrize(
    ("excess", "ratio"), [(1.3, 1.3), (1.25, 1.25), (1.2, 1.2), (1.1, 1.2)]
)
def test_a_stage_makes_up_for_what_the_exact_motion_exceeds(excess, ratio):
    found, _ = enlarged([1.0, 1.2, 1.1], QUIET, Violations(excess, np.zeros(2)))
    more = max(1.0, excess / 1.2)
    expected = [1 / (ratio + GUARD), 1 / (1.1 * more + GUARD)]
    assert found[1].shares == pytest.approx(expected)
    assert found[0].shares.tolist() == [1.0]


def test_violations_of_inequalities_raise_their_bounds_where_they_are():
    lacks = np.array([[0.2, 0.0], [0.0, 0.0], [0.1, 0.0]])
    violations = Violations(0.5, np.array([0.3, 0.04]))
    found, _ = enlarged([0.9] * 3, lacks, violations)
    # 0.1 more than any stage knows of; of the second nobody knows where
    assert found[0].inequalities == pytest.approx(np.array([[0.3, 0.04]]))
    assert found[1].inequalities == pytest.approx(np.array([[0.0, 0.04], [0.2, 0.04]]))
    assert (found[0].shares == 1.0).all()
    less = Violations(0.5, np.array([0.15, 0.0]))
    found, _ = enlarged([0.9] * 3, lacks, less)
    assert found[0].inequalities == pytest.approx(np.array([[0.2, 0.0]]))


@pytest.mark.parametrize(
    ("excess", "lacks", "message"),
    [
        (1.0, [0.0, 0.0], None),
        (1.0 + 1e-9, [0.0, 0.0], "deviates 0.00% more than allowed"),
        (1.25, [0.0, 0.0], "deviates 25.00% more than allowed"),
        (1.0, [0.0, 0.0125], "lacks 0.0125 of its reach"),
        (
            1.5,
            [1.0, 2.0],
            "50.00% more than allowed and lacks 1 of its room and lacks 2",
        ),
    ],
)
def test_violations_are_told_with_their_sizes(excess, lacks, message):
    task = SimpleNamespace(inequalities=(LOW, HIGH))
    violations = Violations(excess, np.array(lacks))
    assert violations.none == (message is None)
    text = violations.message(task)
    assert (message or "") in text
    assert text.endswith(
        " between the points where it was checked; give larger tolerances, or ask for "
        "less"
    )
