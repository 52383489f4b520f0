"""Intervals of 90 % cover the truth of hidden servos about as often as they say."""

import numpy as np
import pytest

from sim.fitting.fitting import SERVO, fit_servos, servos
from tests.sim.fitting.test_servos import EVERY, STEP, commanded, hidden, moves

DRAWS = 100
NINETY = 1.645  # standard errors to either side of an interval of 90 %


def covered(lasting, noise, draws=DRAWS, seed=0):
    """How many of the draws' intervals cover, by number, and its median error.

    Every draw is a joint of its own, with a load that goes up and down.
    """
    rng = np.random.default_rng(seed)
    angle = moves(draws, rng, lasting=lasting)
    phase = rng.uniform(0, 6, draws)
    load = 0.2 * np.sin(np.arange(len(angle))[:, None] * STEP * 3 + phase)
    log = commanded(angle, load)
    rows = np.arange(0, lasting - STEP, EVERY * STEP)
    truth = hidden(draws, rng)
    truth[:, 0] += rng.uniform(-0.3, 0.3, draws)
    truth[:, 1] += rng.uniform(-0.3, 0.3, draws)
    truth[:, 3] = rng.uniform(0.003, 0.012, draws)
    truth[:, 5] = rng.uniform(0.005, 0.04, draws)
    seen = log.answers(truth[None], rows)[0]
    seen += rng.normal(0, np.radians(noise), seen.shape)
    start = servos(np.full(draws, 9.0), np.full(draws, 0.1))
    found = fit_servos(log, rows, seen, start)
    inside = np.abs(found.value - truth) < NINETY * found.error
    names = [p.name for p in SERVO]
    return dict(zip(names, inside.sum(axis=0).tolist(), strict=True)), dict(
        zip(names, np.median(found.error, axis=0).tolist(), strict=True)
    )


@pytest.mark.full
@pytest.mark.parametrize("noise", [0.05, 0.3])  # [degree]
@pytest.mark.parametrize("lasting", [5.0, 15.0, 45.0])  # [s]
def test_intervals_of_90_percent_cover_85_to_95_of_100_draws(lasting, noise):
    inside, _ = covered(lasting, noise)
    assert 85 <= np.mean(list(inside.values())) <= 95
    # each number alone scatters by 3 of 100; 84 to 96 were seen
    assert all(81 <= number <= 99 for number in inside.values())
