"""The set where given functions vanish, such as a stratum where feet have height zero.

Answers which configurations lie on it and how fast a field leaves it (Sec. 5.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from planner.fields import (
    Array,
    CompiledFields,
    NumericField,
    Symbols,
    VectorField,
    compile_fields,
    sample_configurations,
)


@dataclass(frozen=True, eq=False)
class LevelSet:
    """Common zeros of functions of the state.

    Attributes:
        functions: Expressions Phi_i, as many as the set's codimension.
        state: Symbols of the state.
    """

    functions: tuple[sp.Expr, ...]
    state: Symbols

    @cached_property
    def differential(self) -> sp.Matrix:
        """Rows d Phi_i, shape (codimension, n)."""
        return sp.Matrix(self.functions).jacobian(sp.Matrix(self.state))

    def leaves(self, field: VectorField) -> bool:
        """Whether a field is not tangent to the set."""
        return bool(np.abs(self.rates(field)).max(initial=0.0) > 1e-7)

    def rates(self, field: VectorField) -> Array:
        """Rates <d Phi_i, field> at `points`, shape (points, codimension)."""
        if not isinstance(field, NumericField):
            rates = self.differential * field
            if rates.is_zero_matrix:
                return np.zeros((1, len(self.functions)))
            return _stack(rates, self.state)(self.points)[..., 0]
        slopes = np.swapaxes(self.gradients(self.points), -1, -2)
        velocities = compile_fields([field], self.state).values(self.points)
        return (slopes @ velocities)[..., 0]

    @cached_property
    def points(self) -> Array:
        """Random configurations on the set, shape (points, n), by Newton's method.

        Raises:
            ValueError: None is found, or the functions depend on one another (Def. 1).
        """
        found = [
            x
            for x in map(self._project, sample_configurations(len(self.state)))
            if x.size
        ]
        listed = ", ".join(map(str, self.functions))
        if not found:
            raise ValueError(f"found no configuration where {listed} vanish together")
        for x in found:
            if np.linalg.matrix_rank(self.gradients(x), tol=1e-9) < len(self.functions):
                raise ValueError(
                    f"{listed} are not independent where they vanish (Def. 1)"
                )
        return np.array(found)

    def value(self, x: Array) -> Array:
        """The functions at configurations (..., n), shape (..., codimension)."""
        return self._values.values(x)[..., 0]

    def gradients(self, x: Array) -> Array:
        """Gradients at configurations (..., n), shape (..., n, codimension)."""
        if not self.functions:
            return np.zeros((*x.shape, 0))
        return self._gradients.values(x)

    @cached_property
    def _values(self) -> CompiledFields:
        return _stack(sp.Matrix(self.functions), self.state)

    @cached_property
    def _gradients(self) -> CompiledFields:
        return _stack(self.differential.T, self.state)

    def _project(self, x: Array) -> Array:
        for _ in range(30):
            residual = self.value(x)
            if not np.isfinite(residual).all():
                break
            if np.abs(residual).max() < 1e-12:
                return x
            x = x - np.linalg.pinv(self.gradients(x).T) @ residual
        return np.empty(0)


def _stack(matrix: sp.Matrix, state: Symbols) -> CompiledFields:
    """Compile a matrix of expressions; its columns need not be fields."""
    columns: Sequence[sp.Matrix] = [matrix.col(j) for j in range(matrix.cols)]
    return compile_fields(columns, state)
