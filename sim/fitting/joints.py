"""Servos of a robot's joints, from what they were told and what was measured.

Each joint is fitted for itself. Stiffness, damping, backlash and delay are those of one
make, so that all joints together tell them better than each alone.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from planner import Array
from sim.fitting.estimate import Estimates, Parameter, estimate, pooled
from sim.fitting.servo_law import Commanded

SERVO = (
    Parameter(name="stiffness", unit="N m/rad", spread=1.0, step=0.02, logarithm=True),
    Parameter(name="damping", unit="N m s/rad", spread=1.0, step=0.02, logarithm=True),
    Parameter(name="dead band", unit="rad", spread=0.03, step=5e-4, low=0.0),
    Parameter(name="backlash", unit="rad", spread=0.03, step=5e-4, low=0.0),
    Parameter(name="zero", unit="rad", spread=0.05, step=1e-3),
    Parameter(name="delay", unit="s", spread=0.05, step=1e-3, low=0.0),
)
MAKE = (0, 1, 3, 5)  # parameters of a make; dead band and zero are a servo's own
LONGEST_DELAY = 0.3  # [s]; delay that is looked for
APART = 0.01  # [s]; delays that are tried
DAMPINGS = (-0.7, 0.0, 0.7)  # logarithms of factors that are tried
LOOSE = ((0.0, 0.01), (0.0, 0.01))  # [rad]; dead bands and backlash that are tried


def servos(stiffness: Array, damping: Array) -> Array:
    """Servos (P, 6) of known stiffness and damping, (P,), and else without fault."""
    known = np.log([stiffness, damping]).T
    return np.pad(known, ((0, 0), (0, len(SERVO) - 2)))


def fit_servos(
    commanded: Commanded, rows: Array, measured: Array, start: Array
) -> Estimates:
    """Servos of P joints, expected at (P, 6), from angles (N, P) at times (N,) [s]."""
    guess = _scanned(commanded, rows, measured, start)
    return estimate(
        lambda tried: commanded.answers(tried, rows), measured, SERVO, start, guess
    )


def one_make(each: Estimates) -> tuple[Estimates, Estimates, Array]:
    """What the servos share, what each has of its own, and all of it as (P, 6)."""
    make, own = pooled(each, MAKE)
    whole = np.tile(make.value[0][[0, 1, 0, 2, 0, 3]], (len(own.value), 1))
    whole[:, [2, 4]] = own.value
    return make, own, whole


def _scanned(commanded: Commanded, rows: Array, measured: Array, start: Array) -> Array:
    """Servos of a grid that leave over the least, (P, 6), each with its best zero."""
    grid = [*product(DAMPINGS, *LOOSE)]
    tried = np.tile(start, (len(grid), 1, 1))
    tried[..., 1:4] += np.array(grid)[:, None]
    best, least = start.copy(), np.full(len(start), np.inf)
    for servo, found in zip(tried, commanded.answers(tried, rows), strict=True):
        for delay in np.arange(0.0, LONGEST_DELAY, APART):
            late = [np.interp(rows - delay, rows, angle) for angle in found.T]
            off = measured - np.stack(late, axis=1)
            left, zero = np.nanvar(off, axis=0), np.nanmean(off, axis=0)
            better = left < least
            best[better] = servo[better]
            best[better, 4:] = np.column_stack([zero, np.full(len(zero), delay)])[
                better
            ]
            least = np.minimum(left, least)
    return best
