"""Ad of eq. (8), in exact numbers, against products in the tensor algebra."""

import numpy as np
from hypothesis import given, settings, strategies as st

from planner.lie.adjoint import adjoint_action
from planner.lie.free_lie import lie_algebra
from planner.lie.hall import hall_basis
from tests.planner.lie.test_free_lie import equal, numbers


@settings(max_examples=25, deadline=None)  # exact numbers are slow
@given(st.data())
def test_adjoint_action_is_conjugation(data):
    basis = hall_basis(2, 4)
    algebra = lie_algebra(basis)
    b, h = data.draw(numbers(basis)), data.draw(numbers(basis))
    j = data.draw(st.integers(0, len(basis) - 1))
    a = h * np.eye(len(basis), dtype=int)[j]
    moved = adjoint_action(algebra.structure[j], h[j], dict(enumerate(b)))
    conjugate = algebra.expand(a).exp() * algebra.expand(b) * algebra.expand(-a).exp()
    vector = np.array([moved[k] for k in range(len(basis))], dtype=object)
    assert equal(algebra.expand(vector), conjugate)
