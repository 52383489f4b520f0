"""Critical steps of plans of which it is known what part of a step they leave."""

from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import BudgetError, PlannerError
from planner.planning import critical_steps
from planner.planning.critical_steps import (
    _scale,
    _Steps,
    _to_failure,
    critical_step,
    least_critical_step,
)
from planner.systems.strata import StratifiedSystem

ACCURACY = 1e-6  # relative, of the critical step
AT_ONCE = 128  # steps that are planned at once
COARSE = 2.0
LONGEST = 1e3
SHORTEST = 1e-9

RAY = np.array([0.6, 0.8])


def known(part, exact=False):
    """Steps of which a function of their lengths is left; the lengths tried."""

    class Known(_Steps):
        _is_exact = exact
        shortest = SHORTEST

        def __init__(self):
            self.tried = []

        def left(self, steps):
            assert 0 < len(steps) <= AT_ONCE
            lengths = np.linalg.norm(steps, axis=1)
            assert steps == pytest.approx(lengths[:, None] * RAY)
            self.tried.append(lengths)
            return np.array([part(length) for length in lengths])

    return Known()


@pytest.mark.parametrize("critical", [3e-9, 1e-4, 0.0123, 1.0, 7.7, 500.0])
@pytest.mark.parametrize("power", [0.5, 1, 3])
def test_the_step_that_is_just_halved_is_found(critical, power):
    steps = known(lambda length: 0.5 * (length / critical) ** power)
    found = steps.critical(RAY, LONGEST)
    assert found <= critical * (1 + 1e-12)
    assert critical < found * (1 + ACCURACY)
    assert max(map(max, steps.tried)) <= critical * COARSE**5  # none much longer


@pytest.mark.parametrize(
    ("low", "high"), [(2.0, 2.05), (0.5, 0.52), (0.03, 0.0307), (6.0, 6.3)]
)
def test_a_short_range_of_steps_that_fails_is_not_passed_over(low, high):
    """It is two per cent wide, where a notable part of the steps around it is left."""
    steps = known(lambda length: 0.6 if low <= length <= high else 0.06)
    assert steps.critical(RAY, LONGEST) == pytest.approx(low, rel=2 * ACCURACY)


@pytest.mark.parametrize(("before", "tried"), [(0.049, False), (0.051, True)])
def test_steps_are_tried_closely_where_a_notable_part_is_left(before, tried):
    steps = known(lambda length: before if length < 500 else 0.6)
    assert steps.critical(RAY, LONGEST) == pytest.approx(500, rel=2 * ACCURACY)
    short = np.unique(np.concatenate(steps.tried).round(12))
    between = (short > 1) & (short < 100)
    ratios = np.diff(np.log(short[between]))
    assert np.median(ratios) < np.log(1.03) if tried else ratios.min() > np.log(1.9)


@pytest.mark.parametrize("nearly", [0.399, 0.401])
def test_around_a_maximum_that_nearly_fails_steps_are_tried_more_closely(nearly):
    """A peak between two steps that are tried, of which the nearest misses the top."""
    grid = np.concatenate(known_grid())
    at = int(np.searchsorted(grid, 3.0))
    low, peak, high = grid[at - 1], grid[at], grid[at + 1]
    inside = np.sqrt(peak * high)

    def part(length):
        if abs(length - inside) < 0.3 * (high - peak):
            return 0.6
        return nearly if low < length < high else 0.1

    found = known(part).critical(RAY, 8.0)
    assert (found < high) == (nearly > 0.4)
    assert found == pytest.approx(inside, rel=0.01) or found == inf


def known_grid():
    """The steps that are tried where none fails."""
    steps = known(lambda length: 0.1)
    assert steps.critical(RAY, 8.0) == inf
    return steps.tried[-40:]


def test_where_every_step_fails_or_none_does_there_is_no_critical_one():
    assert known(lambda length: 0.51).critical(RAY, LONGEST) == 0.0
    assert known(lambda length: 0.5).critical(RAY, 20 * SHORTEST) == inf
    assert known(lambda length: 0.0).critical(RAY, LONGEST) == inf


@pytest.mark.parametrize(("longest", "asked"), [(SHORTEST, 0), (2 * SHORTEST, 1)])
def test_steps_as_short_as_rounding_are_not_tried(longest, asked):
    steps = known(lambda length: 0.1)
    assert steps.critical(RAY, longest) == inf
    assert (len(steps.tried) > 0) == asked
    assert all(lengths.max() <= longest * (1 + 1e-12) for lengths in steps.tried)


@pytest.mark.parametrize("exact", [False, True])
def test_what_fails_by_rounding_alone_is_exact(exact):
    """Plans that leave nothing of any step but the longest fail there by rounding."""
    steps = known(lambda length: 1e-10 if length < 300 else 0.6, exact)
    found = steps.critical(RAY, LONGEST)
    assert found == (inf if exact else pytest.approx(300, rel=2 * ACCURACY))
    steps = known(lambda length: 1e-8 if length < 300 else 0.6, exact)
    assert steps.critical(RAY, LONGEST) == pytest.approx(300, rel=2 * ACCURACY)


@pytest.mark.parametrize(
    ("low", "high", "ratio"), [(1.0, 8.0, 2.0), (1e-9, 1e3, 64.0), (2.0, 2.01, 1.02)]
)
def test_a_scale_goes_from_end_to_end_in_steps_of_about_a_ratio(low, high, ratio):
    scale = _scale(low, high, ratio)
    assert (scale[0], scale[-1]) == pytest.approx((low, high))
    ratios = scale[1:] / scale[:-1]
    assert ratios == pytest.approx(ratios[0])
    assert ratios[0] <= ratio * (1 + 1e-12)
    assert ratios[0] ** 2 > min(ratio, high / low)


@pytest.mark.parametrize("block", [1, 3, 4, 100])
def test_steps_are_tried_in_blocks_up_to_the_first_that_fails(block):
    tried, steps = [], np.arange(1.0, 11.0)

    def left(part):
        tried.append(part.tolist())
        return np.where(part >= 6, 0.6, 0.5)

    found, parts = _to_failure(left, steps, block)
    assert found.tolist() == [1, 2, 3, 4, 5, 6]
    assert parts.tolist() == [0.5] * 5 + [0.6]
    assert all(len(part) <= block for part in tried)
    assert sum(tried, []) == steps[: min(10, -(-6 // block) * block)].tolist()
    never, parts = _to_failure(lambda part: 0 * part, steps, block)
    assert (never.tolist(), len(parts)) == (steps.tolist(), 10)


def test_of_steps_in_between_the_first_that_fails_is_found():
    steps = known(lambda length: 0.6 if length > 1.5 else 0.4)
    low, top = steps.failing(RAY, 1.0, 2.0)
    assert 1.0 < low <= 1.5 < top < 2.0
    assert top / low == pytest.approx(2 ** (1 / 17))  # sixteen between them
    low, top = known(lambda length: 0.4).failing(RAY, 1.0, 2.0)
    assert (top, low) == pytest.approx((2.0, 2 ** (16 / 17)))  # the last was known


def least(part, dimension, monkeypatch):
    """The least critical step where a function of the steps (k, n) is left."""
    names = "xyzuvw"[:dimension]
    rows = np.eye(dimension, dtype=int).tolist()
    fields = dict(zip(names, rows, strict=True))
    plain = StratifiedSystem(" ".join(names), {"0": fields}, "0")

    class Known(_Steps):
        shortest = SHORTEST

        def __init__(self, system, at, execution):
            self.system, self.start = plain, np.asarray(at, dtype=float)

        def left(self, steps):
            return part(steps)

    monkeypatch.setattr(critical_steps, "_Steps", Known)
    return least_critical_step(plain, np.zeros(dimension))


@pytest.mark.parametrize("dimension", [1, 2, 3, 5])
@pytest.mark.parametrize("size", [1e-5, 0.3, 40.0])
def test_the_least_step_is_found_in_whichever_direction(dimension, size, monkeypatch):
    way = np.random.default_rng(dimension).normal(size=dimension)
    way /= np.linalg.norm(way)

    def part(steps):  # critical is the size along the way, and more beside it
        lengths = np.linalg.norm(steps, axis=1)
        cosine = steps @ way / lengths
        return 0.5 * lengths / (size * (2.0 - cosine))

    found = least(part, dimension, monkeypatch)
    assert found == pytest.approx(size, rel=2e-3)
    assert found == least(part, dimension, monkeypatch)


def test_where_no_step_fails_in_any_direction_there_is_no_least_one(monkeypatch):
    assert least(lambda steps: np.full(len(steps), 0.5), 3, monkeypatch) == inf


def stepping(words, system=None):
    """Steps whose words, or the error of making them, are given."""
    steps = _Steps.__new__(_Steps)
    asked = []

    def made(coordinates, order, starts):
        asked.append(len(starts))
        if isinstance(words, Exception) and len(starts) > 1:
            raise words
        return words

    steering = SimpleNamespace(hall_coordinates=lambda inputs: inputs, words=made)
    steps.start, steps.order = np.zeros(2), "backward"
    steps.extended = SimpleNamespace(steering=steering)
    steps.system = SimpleNamespace(length=lambda x: np.linalg.norm(x, axis=-1))
    return steps, asked


def test_steps_that_cannot_be_planned_together_are_planned_apart(monkeypatch):
    monkeypatch.setattr(
        critical_steps, "fictitious_inputs_along", lambda extended, samples: samples
    )
    ends = lambda system, words, starts, nodes: starts + [0.75, 0.0]  # noqa: E731
    monkeypatch.setattr(critical_steps, "word_ends", ends)
    steps, asked = stepping(PlannerError("no words"))
    parts = steps.left(
        np.array([[1.0, 0.0], [3.0, 0.0], [0.0, 1.0], [2.0, 0.0], [1, 0]])
    )
    assert parts == pytest.approx([0.25, 0.75, 1.25, 0.625, 0.25])
    assert asked == [5, 2, 1, 1, 3, 1, 2, 1, 1]
    steps, _ = stepping(BudgetError(1.0, ""))
    with pytest.raises(BudgetError):
        steps.left(np.ones((2, 2)))


def test_directions_are_finite_and_not_zero():
    system = StratifiedSystem("x y", {"0": {"f": [1, 0], "g": [0, 1]}}, "0")
    for way in ([0, 0], [np.inf, 0], [np.nan, 1]):
        with pytest.raises(ValueError, match="give one that is finite and not zero"):
            critical_step(system, (0, 0), way)
    assert critical_step(system, (0, 0), (0, 1e-9)) == inf
