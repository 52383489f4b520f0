"""How large a basis is made, and which durations and inputs are none."""

import numpy as np
import pytest

from planner.errors import ConvergenceError
from planner.lie import coordinates, hall
from planner.lie.coordinates import backward
from planner.lie.hall import hall_basis
from planner.lie.input_words import joined


def test_a_basis_has_a_million_elements_at_most(monkeypatch):
    """1413 generators have 998,991 to degree two, and 1414 have 1,000,405."""
    monkeypatch.setattr(hall, "Bracket", lambda *_: pytest.fail("they are made"))
    with pytest.raises(ValueError, match="more than 1,000,000 Hall elements"):
        hall_basis(1414, 2)


def test_flows_are_left_out_below_a_trillionth():
    letters, durations = joined([1, 2, 1, 2], [0.9e-12, 1.1e-12, -0.9e-12, 1.0])
    assert (letters, durations) == ((2,), [1.1e-12 + 1.0])
    assert joined([1], [-0.99e-12]) == ((), [])
    assert joined([1], [-1.01e-12]) == ((1,), [-1.01e-12])


def test_inputs_are_evaluated_a_hundred_thousand_times_at_most(monkeypatch):
    calls = []

    def restless(algebra, inputs, *rest):
        while True:
            inputs(0.5)

    monkeypatch.setattr(coordinates, "_adapted", restless)
    with pytest.raises(ConvergenceError, match="inputs still change"):
        backward(hall_basis(1, 1), lambda t: calls.append(t) or np.ones(1))
    assert len(calls) == 100_000
