"""Servos of one make: what all joints share is searched for together.

What a joint's log says is far from quadratic in stiffness, damping and delay: smooth
commands are followed much alike by stiff servos and by soft ones that are damped less
or answer sooner. So the search goes on at what joints share, and begins more than once.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import sqrt

import numpy as np

from planner import Array
from sim.fitting import estimate
from sim.fitting.servo_law import Commanded

SERVO = estimate.parameters_of("servo")
MAKE = (0, 1, 3, 5)  # parameters of a make
OWN = (2, 4)  # dead band and zero, a servo's own
ALIKE = [0, 1, 3]  # of a make: stiffness, damping and delay, which can look the same
LONGEST_STEP = 2.0  # of logarithms; others are far shorter
PARTS = np.array([0.0, 1.0, 0.3, 0.1, 0.03])  # of a step, of which the best is taken
UNLIKE = 2.0  # standard errors between a joint alone and as one of its make
AS_LIKELY = 10.0  # logarithms of likelihoods that are closer tell no makes apart

Told = tuple[Commanded, Array, Array]  # with times (N,) [s] and angles (N, P) [rad]


def one_make(
    each: estimate.Estimates,
) -> tuple[estimate.Estimates, estimate.Estimates, Array]:
    """What the servos share, what each has of its own, and all of it as (P, 6)."""
    make, own = estimate.pooled(each, MAKE)
    whole = np.tile(make.value[0][[0, 1, 0, 2, 0, 3]], (len(own.value), 1))
    whole[:, OWN] = own.value
    return make, own, whole


def shared_make(
    told: Sequence[Told], start: Array, each: estimate.Estimates
) -> tuple[estimate.Estimates, estimate.Estimates, estimate.Estimates, Array]:
    """The joints, and what `one_make` finds, but at their best common make.

    The search begins at several stiffnesses; errors reach to makes that fit alike, and
    those of a servo's own numbers to what an unlike joint tells alone.
    """
    begins = _guesses(told[0][0].inertia, each)
    found = [_searched(told, start, guess) for guess in begins]
    cost, there, whole = min(found, key=lambda one: one[0])
    alike = [servos[0] for other, _, servos in found if other < cost + AS_LIKELY]
    apart = np.abs(alike - whole[0])[:, MAKE] / estimate.pooled(there, MAKE)[0].error
    weight = 1 / max(1.0, apart[:, ALIKE].max()) ** 2
    make, own = estimate.pooled(there, MAKE, weight)
    make, off = replace(make, value=whole[:1, MAKE]), np.abs(whole - each.value)[:, OWN]
    unlike = off > UNLIKE * each.error[:, OWN]
    own = replace(own, value=whole[:, OWN], reach=np.where(unlike, off, 0.0))
    alone = np.sum([_unlikely(*one, np.stack([each.value, whole])) for one in told], 0)
    alike = alone[1] < alone[0] + AS_LIKELY  # joints that a common servo fits as well
    reach = np.where(alike[:, None], np.abs(whole - each.value), 0.0)
    each = replace(each, information=weight * each.information, reach=reach)
    return each, make, own, whole


def _guesses(inertia: Array, each: estimate.Estimates) -> Iterator[Array]:
    """Servos (P, 6) of one make, from stiff to soft, that move legs much alike.

    Smooth commands are followed with a lag of d / k and the delay, and a swing that
    grows with I / k - (d / k)^2 / 2; where these stay, other stiffnesses look the same.
    """
    whole = each.value.copy()
    whole[:, MAKE] = np.median(each.value[:, MAKE], axis=0)
    (k, d), delay, moment = np.exp(whole[0, :2]), whole[0, 5], float(np.median(inertia))
    for softer in 2.0 ** np.arange(-1, 7):  # parts of a stiffness
        square = 2 * moment / k * (softer - 1) + (d / k) ** 2
        lag = sqrt(max(square, 0.0))
        if 0 < lag <= d / k + delay:
            guess = whole.copy()
            guess[:, :2] = np.log([k / softer, k / softer * lag])
            guess[:, 5] = d / k + delay - lag
            yield guess


def _searched(
    told: Sequence[Told], start: Array, guess: Array
) -> tuple[float, estimate.Estimates, Array]:
    """How unlikely servos of one make are, each alone, and all, by Gauss and Newton."""
    low, spread = np.array([(p.low, p.spread) for p in SERVO]).T
    whole = np.maximum(guess, low)
    for _ in range(8):
        ways = [
            estimate.led(partial(c.answers, rows=rows), seen, SERVO, start, whole, MAKE)
            for c, rows, seen in told
        ]
        *_, new = one_make(each := estimate.together(ways))
        way = np.clip(new - whole, -LONGEST_STEP, LONGEST_STEP)
        tried = np.maximum(whole + PARTS[:, None, None] * way, low)
        expected = ((tried - start) / spread)[..., MAKE] ** 2
        costs = np.sum([_unlikely(*one, tried).sum(axis=-1) for one in told], axis=0)
        costs += expected.mean(axis=1).sum(axis=-1) / 2
        if costs.min() > costs[0] - estimate.SETTLED:
            break
        whole = tried[costs.argmin()]
    return float(costs.min()), each, whole


def _unlikely(commanded: Commanded, rows: Array, angles: Array, tried: Array) -> Array:
    """Logarithms of how unlikely variants of servos are, (V, P, 6), shape (V, P)."""
    left = angles - commanded.answers(tried, rows)
    count = np.isfinite(angles).sum(axis=0)
    squares = np.nansum(left**2, axis=1) / np.maximum(count, 1)
    return np.asarray(count / 2 * np.log(squares + estimate.LEAST_NOISE**2))
