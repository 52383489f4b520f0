"""Estimates against least squares, in which what is expected is one more row."""

import numpy as np
import pytest
from numpy.linalg import inv, lstsq

from sim.fitting.estimate import (
    Estimates,
    Parameter,
    _alike,
    _in_words,
    _newton_step,
    estimate,
    parameters_of,
    pooled,
    solved,
    together,
)

UNSEEN = 0.5  # of the spread of a direction that measurements leave

ROWS, PROBLEMS, SPREADS = 60, 3, np.array([2.0, 0.5, 1.0])
START = np.array([[0.3, -0.2, 1.0], [0.0, 0.1, 0.5], [-1.0, 0.4, 0.2]])


def named(spreads=SPREADS, **same):
    return tuple(
        Parameter(name=name, unit="m", spread=float(spread), step=1e-3, **same)
        for name, spread in zip("abcd", spreads, strict=False)
    )


def linear(seed=3, noise=0.1):
    """Slopes (P, N, K) of a linear model, its truth and what is measured (N, P)."""
    rng = np.random.default_rng(seed)
    slopes = rng.normal(size=(PROBLEMS, ROWS, len(SPREADS)))
    truth = START + 0.3 * rng.normal(size=START.shape)
    seen = np.einsum("pnk,pk->np", slopes, truth)
    return slopes, truth, seen + noise * rng.normal(size=seen.shape)


def fitted(slopes, seen, guess=START, **options):
    def model(tried):
        return np.einsum("pnk,vpk->vnp", slopes, tried)

    return estimate(model, seen, named(), START, guess, **options)


def with_expectation(slope, seen, noise, start):
    """Least squares of one problem, the start a measurement with its spread."""
    rows = np.concatenate([slope / noise, np.diag(1 / SPREADS)])
    wanted = np.concatenate([seen / noise, start / SPREADS])
    return lstsq(rows, wanted, rcond=None)[0], inv(rows.T @ rows)


def test_estimates_are_those_of_least_squares_with_what_was_expected():
    slopes, _, seen = linear()
    found = fitted(slopes, seen)
    for p in range(PROBLEMS):
        left = seen[:, p] - slopes[p] @ found.value[p]
        noise = np.sqrt(left @ left / (ROWS - 3))
        assert found.noise[p] == pytest.approx(noise, rel=1e-6)
        best, errors = with_expectation(slopes[p], seen[:, p], noise, START[p])
        assert found.value[p] == pytest.approx(best, abs=0.02 * noise)
        assert found.error[p] == pytest.approx(np.sqrt(np.diag(errors)), rel=1e-5)
        information = slopes[p].T @ slopes[p] / noise**2
        assert found.information[p] == pytest.approx(information, rel=1e-5)
        evidence = slopes[p].T @ seen[:, p] / noise**2
        assert found.evidence[p] == pytest.approx(
            evidence, abs=0.05 * abs(evidence).max()
        )


def test_rows_in_which_nothing_was_measured_do_not_count():
    slopes, _, seen = linear()
    holes = seen.copy()
    holes[40:] = np.nan
    few = fitted(slopes[:, :40], seen[:40])
    found = fitted(slopes, holes)
    assert found.value == pytest.approx(few.value)
    assert found.noise == pytest.approx(few.noise)


def test_as_many_rows_as_parameters_still_have_a_noise():
    """What is left over is then told of one row, and not of none."""
    slopes, _, seen = linear(noise=0.5)
    found = fitted(slopes[:, :3], seen[:3])
    left = seen[:3] - np.einsum("pnk,pk->np", slopes[:, :3], found.value)
    assert found.noise == pytest.approx(np.sqrt((left**2).sum(axis=0)))


def test_a_search_goes_as_many_rounds_as_it_may():
    slopes, _, seen = linear()
    rounds = []

    def model(tried):
        rounds.append(len(tried))
        return np.einsum("pnk,vpk->vnp", slopes, tried)

    far = START + 5.0
    estimate(model, seen, named(), START, far, steps=1)
    assert rounds == [1 + 3, 3]  # the values, each changed, and three lengths of a step


def test_a_value_that_is_led_below_its_least_stays_there():
    slopes, _, seen = linear()
    free = fitted(slopes, seen)
    low = float(free.value[:, 0].min()) + 0.5
    bounded = [Parameter(name="a", unit="m", spread=2.0, step=1e-3, low=low)]

    def model(tried):
        return np.einsum("pnk,vpk->vnp", slopes, tried)

    guess = np.maximum(START, [low, -np.inf, -np.inf])
    found = estimate(model, seen, [*bounded, *named()[1:]], START, guess)
    held = free.value[:, 0] < low
    assert held.any()
    assert found.value[held, 0] == pytest.approx(low)
    for p in np.flatnonzero(held):  # the others are fitted as if it were known
        rest = seen[:, p] - low * slopes[p][:, 0]
        rows = np.concatenate(
            [slopes[p][:, 1:] / found.noise[p], np.diag(1 / SPREADS[1:])]
        )
        wanted = np.concatenate([rest / found.noise[p], START[p, 1:] / SPREADS[1:]])
        best = lstsq(rows, wanted, rcond=None)[0]
        assert found.value[p, 1:] == pytest.approx(best, abs=0.02 * found.noise[p])


def test_unknowns_that_are_held_do_not_move_nor_count():
    matrix = np.array([[[4.0, 1.0, 0.5], [1.0, 3.0, 0.2], [0.5, 0.2, 2.0]]])
    toward, held = np.array([[1.0, -2.0, 3.0]]), np.array([[False, True, False]])
    (step,) = _newton_step(matrix, toward, held)
    assert step[1] == 0
    assert matrix[0][np.ix_([0, 2], [0, 2])] @ step[[0, 2]] == pytest.approx([1.0, 3.0])


@pytest.mark.parametrize("r", [0.0, 0.5, 0.8])
def test_rows_that_say_the_same_count_as_one(r):
    """Of a first-order process, (1 + r) / (1 - r) rows are one."""
    rng = np.random.default_rng(1)
    left = rng.normal(size=(20_000, 1))
    for n in range(1, len(left)):
        left[n] += r * left[n - 1]
    there = np.isfinite(left)
    assert _alike(left, there) == pytest.approx((1 + r) / (1 - r), rel=0.08)
    opposite = left * np.where(np.arange(len(left)) % 2, -1, 1)[:, None]
    assert _alike(opposite, there) == 1.0


def test_a_correlation_that_chance_explains_is_none():
    """Two standard errors of a correlation of N pairs are 2 over the root of N."""
    left = np.ones((1, 1)).repeat(5, axis=0)
    assert _alike(left[:2], np.ones((2, 1), bool)) == 1.0  # 1/2 of one pair
    long = np.ones((101, 1))
    assert _alike(long, np.ones((101, 1), bool)) > 100
    gaps = np.zeros((101, 1), bool)
    gaps[::2] = True  # no two rows follow one another
    assert _alike(np.where(gaps, long, 0.0), gaps) == 1.0


def test_problems_measured_twice_are_those_measured_at_once():
    slopes, _, seen = linear(noise=0.05)
    one, other = fitted(slopes[:, :30], seen[:30]), fitted(slopes[:, 30:], seen[30:])
    both = together([one, other])
    assert both.information == pytest.approx(one.information + other.information)
    mean = np.sqrt((one.noise**2 + other.noise**2) / 2)
    assert both.noise == pytest.approx(mean)
    for p in range(PROBLEMS):
        noise = np.repeat([one.noise[p], other.noise[p]], 30)
        scaled = slopes[p] / noise[:, None]
        best, _ = with_expectation(scaled, seen[:, p] / noise, 1.0, START[p])
        assert both.value[p] == pytest.approx(best, abs=2e-3)
    assert together([one]) is one


@pytest.mark.parametrize("shared", [[0], [1], [0, 2], [2, 1]])
def test_what_problems_share_is_that_of_one_large_problem(shared):
    """All problems as one, with one unknown for what they share."""
    slopes, _, seen = linear(noise=0.05)
    start = START.copy()
    start[:, shared] = START[0, shared]  # expected of all alike
    each = [*named()]

    def model(tried):
        return np.einsum("pnk,vpk->vnp", slopes, tried)

    found = estimate(model, seen, each, start, start)
    one, own = pooled(found, shared)
    mine = [k for k in range(3) if k not in shared]
    width = len(shared) + PROBLEMS * len(mine)
    matrix, right = np.zeros((width, width)), np.zeros(width)
    for p in range(PROBLEMS):
        place = np.empty(3, dtype=int)
        place[shared] = range(len(shared))
        place[mine] = len(shared) + p * len(mine) + np.arange(len(mine))
        matrix[np.ix_(place, place)] += found.information[p]
        right[place] += found.evidence[p]
        matrix[place[mine], place[mine]] += 1 / SPREADS[mine] ** 2
        right[place[mine]] += start[p, mine] / SPREADS[mine] ** 2
    for n, k in enumerate(shared):
        matrix[n, n] += 1 / SPREADS[k] ** 2
        right[n] += start[0, k] / SPREADS[k] ** 2
    best, error = np.linalg.solve(matrix, right), np.sqrt(np.diag(inv(matrix)))
    count = len(shared)
    assert one.value[0] == pytest.approx(best[:count], rel=1e-6)
    assert one.error[0] == pytest.approx(error[:count], rel=1e-6)
    assert own.value.ravel() == pytest.approx(best[count:], rel=1e-6)
    assert own.error.ravel() == pytest.approx(error[count:], rel=1e-6)
    assert one.noise == pytest.approx(np.sqrt(np.mean(found.noise**2)))
    assert [p.name for p in one.parameters] == [each[k].name for k in shared]
    assert [p.name for p in own.parameters] == [each[k].name for k in mine]


def test_shared_and_own_values_do_not_fall_below_their_least():
    slopes, _, seen = linear(noise=0.05)
    found = fitted(slopes, seen)
    top = float(found.value.max()) + 1
    high = tuple(
        Parameter(name=p.name, unit="m", spread=p.spread, step=p.step, low=top)
        for p in found.parameters
    )
    least = Estimates(high, found.start, found.value, found.information, found.noise)
    one, own = pooled(least, [0])
    assert (one.value == top).all()
    assert (own.value == top).all()


def test_a_logarithm_is_told_as_the_number_that_it_is_of():
    parameters = (
        Parameter(name="log", unit="", spread=1.0, step=0.1, logarithm=True),
        Parameter(name="plain", unit="", spread=1.0, step=0.1),
    )
    value = np.array([[np.log(3.0), 4.0]])
    information = np.diag([99.0, 24.0])[None]  # with 1 of what was expected
    found = Estimates(parameters, value, value, information, np.ones(1))
    assert found.error[0] == pytest.approx([0.1, 0.2])
    assert found.of(0) == pytest.approx((3.0, 0.3))
    assert found.of(1) == pytest.approx((4.0, 0.2))


@pytest.mark.parametrize("left", [0.9 * UNSEEN, 1.1 * UNSEEN])
def test_a_parameter_is_seen_where_half_of_its_spread_is_gone(left):
    (parameter,) = named([3.0])
    value = np.zeros((1, 1))
    information = np.array([[[(1 / left**2 - 1) / 9.0]]])
    found = Estimates((parameter,), value, value, information, np.ones(1))
    assert found.error[0, 0] == pytest.approx(3.0 * left)
    assert found.seen[0, 0] == (left < UNSEEN)
    assert found.unseen() == ([] if left < UNSEEN else ["a does not show"])


@pytest.mark.parametrize(
    ("direction", "said"),
    [
        ([0.0, 1.0, 0.0], "b does not show"),
        ([0.2, -0.96, 0.2], "b does not show"),  # parts below a quarter
        ([0.8, 0.6, 0.0], "more a with more b would look the same"),
        ([-0.8, 0.6, 0.0], "more a with less b would look the same"),
        ([-0.5, 0.6, -0.62], "more c with less b with more a would look the same"),
    ],
)
def test_a_direction_that_is_not_seen_is_told_in_words(direction, said):
    assert _in_words(["a", "b", "c"], np.array(direction)) == said


def test_evidence_alone_gives_the_start_where_there_is_none():
    nothing = np.zeros((1, 3, 3)), np.zeros((1, 3)), np.zeros(1)
    found = solved(named(), START[:1], *nothing)
    assert found.value == pytest.approx(START[:1])
    assert found.error[0] == pytest.approx(SPREADS)
    assert not found.seen.any()
    assert len(found.unseen()) == 3


@pytest.mark.parametrize("what", ["servo", "body"])
def test_numbers_that_cannot_be_negative_have_a_least_value(what):
    for parameter in parameters_of(what):
        positive = parameter.name in {
            "dead band", "backlash", "delay", "friction", "payload",
        }  # fmt: skip
        assert np.isfinite(parameter.low) == positive
        assert parameter.logarithm == (parameter.name in {"stiffness", "damping"})
