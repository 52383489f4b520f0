"""Ad, eq. (8), and with it the rates of Hall coordinates, eq. (7).

A flow S = e^(h_s B_s) ... e^(h_1 B_1) has S^-1 S' = sum_j Ad(...) B_j h_j'. The sums
here are dictionaries of coefficients by index in the basis, whose numbers may be
floats, arrays over many segments or polynomials; `coordinates` solves eq. (9) with it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from planner.lie.free_lie import LieAlgebra

Number = Any  # float, array or polynomial
Terms = dict[int, Number]  # coefficients by index in the basis


def coordinate_rates(
    algebra: LieAlgebra, terms: Terms, coordinate: Callable[[int, Number], Number]
) -> Terms:
    """Rates h' for which S^-1 S' is the given sum of terms, eq. (7).

    S^-1 S' = sum_j Ad(e^(-h_1 B_1) ... e^(-h_(j-1) B_(j-1))) B_j h_j', so h_1' is the
    coefficient of B_1. Ad(e^(h_1 B_1)) of the other terms is the same sum without B_1.

    Terms are coefficients by index, of any type that can be added and multiplied;
    `coordinate` gives h_j from its index and rate, None for zero.

    Example:
        >>> from planner import LieAlgebra, coordinate_rates, hall_basis
        >>> algebra = LieAlgebra(hall_basis(2, 2))
        >>> h = [0.5, 0.5, 0.0]
        >>> coordinate_rates(algebra, {0: 1.0, 1: 1.0}, lambda j, rate: h[j])
        {0: 1.0, 1: 1.0, 2: 0.5}
    """
    rates, terms = {}, dict(terms)
    for j, structure in enumerate(algebra.structure):
        rate = terms.pop(j, None)
        h = coordinate(j, rate)
        if rate is not None:
            rates[j] = rate
        if h is not None:
            terms = adjoint_action(structure, h, terms)
    return rates


def adjoint_action(
    structure: Mapping[int, Mapping[int, int]], h: Number, terms: Terms
) -> Terms:
    """Ad(e^(h B)) of a sum of terms, e^(h B) (sum) e^(-h B), eq. (8).

    Eq. (8) has Ad(e^(-h B)), which gives the sum from the rates. This is its inverse,
    which recovers the rates from the sum.

    The structure constants of B are the coefficients of [B, B_j] for each j, and terms
    are coefficients by index.

    Example:
        >>> from planner import LieAlgebra, adjoint_action, hall_basis
        >>> algebra = LieAlgebra(hall_basis(2, 2))
        >>> adjoint_action(algebra.structure[0], 0.5, {1: 1.0})
        {1: 1.0, 2: 0.5}
    """
    total, power, n = dict(terms), terms, 0
    while power:
        n, before, power = n + 1, power, {}
        for j in structure.keys() & before.keys():
            for k, c in structure[j].items():
                term = before[j] * h * c / n
                power[k] = power[k] + term if k in power else term
        for k, term in power.items():
            total[k] = total[k] + term if k in total else term
    return total
