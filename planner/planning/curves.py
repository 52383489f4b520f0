"""Curves of poses from formulas or a table, with their arc length by quadrature."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import sympy as sp
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from planner.numerics.arrays import Array
from planner.planning.paths import Path
from planner.systems.formulas import read_formula

COLUMNS = ("x", "y", "yaw")  # [m], [m], [rad]
PRECISION = 1e-12  # of the arc length, relative


def formula_curve(formulas: Mapping[str, object]) -> tuple[Path, float]:
    """Poses x(s), y(s), yaw(s) for s in [0, 1], and the arc length [m].

    Args:
        formulas: Formulas or numbers by the names of `COLUMNS`; those missing are 0.

    Raises:
        ValueError: One of them is no formula of s, or not finite somewhere, or all are
            constant.
    """
    s = sp.Symbol("s", real=True)
    exprs = []
    for name in COLUMNS:
        text = formulas.get(name, 0)
        if isinstance(text, bool) or not isinstance(text, str | int | float):
            raise ValueError(f"{name} is {text!r}; write a formula of s")
        exprs.append(read_formula(text, [s]))
    pose = [sp.lambdify(s, e, modules="numpy") for e in exprs]
    rate = [sp.lambdify(s, sp.diff(e, s), modules="numpy") for e in exprs[:2]]

    def at(parameters: Array) -> Array:
        with np.errstate(all="ignore"):
            columns = [np.broadcast_to(f(parameters), parameters.shape) for f in pose]
        return np.stack(columns, axis=-1).astype(float)

    places = np.linspace(0.0, 1.0, 1001)
    poses = at(places)
    finite = np.isfinite(poses).all(axis=1)
    if not finite.all():
        raise ValueError(f"not finite at s = {places[~finite][0]:.4g}; keep it finite")
    if (poses == poses[0]).all():
        raise ValueError("all poses are the same; let x, y or yaw change with s")
    return Path(at), _arc_length(lambda t: np.hypot(*(f(t) for f in rate)), [0.0, 1.0])


def table_curve(poses: Sequence[Sequence[float]]) -> tuple[Path, float]:
    """A smooth curve through poses, and the arc length [m].

    Between the poses each coordinate is a cubic that does not overshoot, s by the
    length travelled; so dense tables have no corners.

    Args:
        poses: At least two different poses, shape (k, 3).

    Raises:
        ValueError: All poses are the same.
    """
    knots = np.array(poses, dtype=float)
    steps = np.linalg.norm(np.diff(knots, axis=0), axis=1)
    knots = knots[np.concatenate([[True], steps > 0])]
    if len(knots) < 2:
        raise ValueError("all poses are the same; give at least two different ones")
    where = np.concatenate([[0.0], np.cumsum(steps[steps > 0])]) / steps.sum()
    where[-1] = 1.0
    spline = PchipInterpolator(where, knots)
    rate = spline.derivative()
    cuts = where.tolist()
    return Path(spline), _arc_length(lambda t: np.hypot(*rate(t)[:2]), cuts)


def _arc_length(speed: Callable[[float], float], cuts: Sequence[float]) -> float:
    pieces = zip(cuts[:-1], cuts[1:], strict=True)
    options = {"epsabs": 0.0, "epsrel": PRECISION, "limit": 500}
    return float(sum(quad(speed, a, b, **options)[0] for a, b in pieces))
