"""Level sets Phi_i = 0, such as strata on which feet have height zero (Def. 1)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from planner.errors import point
from planner.numerics.arrays import Array
from planner.numerics.subspaces import rank
from planner.systems import fields
from planner.systems.rounding import TRUSTED, WeighedValues

FADED = 1e-6  # of a function's slope, that is none where the function vanishes
TOUCHED = 1e-12  # value that only functions without a slope are left with


@dataclass(frozen=True, eq=False)
class LevelSet:
    """The set of common zeros of functions of the state.

    Attributes:
        functions: Expressions Phi_i, as many as the codimension of the set.
        state: Symbols of the state.

    Example:
        >>> import numpy as np
        >>> from sympy import symbols
        >>> from planner import LevelSet
        >>> x, h = symbols("x h")
        >>> LevelSet((h,), (x, h)).value(np.array([2.0, 0.1]))
        array([0.1])
    """

    functions: tuple[sp.Expr, ...]
    state: fields.Symbols

    @cached_property
    def differential(self) -> sp.Matrix:
        """The differentials d Phi_i as rows, shape (codimension, n)."""
        return sp.Matrix(self.functions).jacobian(sp.Matrix(self.state))

    def leaves(self, field: fields.VectorField) -> bool:
        """Whether a field is not tangent to the set (Sec. 5.1)."""
        return bool(self.rates(field).any())

    def rates(self, field: fields.VectorField) -> Array:
        """Rates <d Phi_i, field> at `points`, shape (points, codimension).

        A rate that is a mere rounding error is zero, and so is one that is singular.
        There is only one row, of zeros, if the formulas show that all rates vanish.
        """
        if not isinstance(field, fields.NumericField):
            formulas = self.differential * field
            if formulas.is_zero_matrix:
                return np.zeros((1, len(self.functions)))
            rates = WeighedValues(self.state, self.points)(formulas)
            return np.where(np.isfinite(rates), rates, 0.0)
        velocities = WeighedValues(self.state, self.points)(field)[:, None]
        terms = np.swapaxes(self.gradients(self.points), -1, -2) * velocities
        rates, sizes = terms.sum(axis=-1), np.abs(terms).sum(axis=-1)
        return np.where(np.abs(rates) > TRUSTED * sizes, rates, 0.0)

    @cached_property
    def points(self) -> Array:
        """Random configurations on the set, shape (points, n), by Newton's method.

        Raises `ValueError` if none is found, or the functions are dependent there (Def.
        1).
        """
        x = fields.sample_configurations(len(self.state))
        steepest = np.zeros(len(self.functions))
        for _ in range(30):  # far fewer suffice where Newton's method converges
            residual, slopes = self._linear(x)
            steepest = np.maximum(steepest, _steepness(slopes))
            sound = np.isfinite(residual).all(axis=1) & np.isfinite(slopes).all((1, 2))
            step = np.linalg.pinv(slopes[sound]) @ residual[sound, :, None]
            x = x[sound] - step[..., 0]
            if not step.any():
                break
        residual, slopes = self._linear(x)
        there = ~residual.any(axis=1)
        faded = (_steepness(slopes) <= FADED * steepest).any()
        # without a slope functions come to zero ever more slowly
        faded |= not there.any() and (np.abs(residual).max(axis=1) < TOUCHED).any()
        if faded or any(rank(rows.T) < len(self.functions) for rows in slopes[there]):
            raise ValueError(self._singular)
        if not there.any():
            listed = ", ".join(map(str, self.functions))
            raise ValueError(f"found no configuration where {listed} vanish together")
        return x[there]

    def require_regular(self, x: Array) -> None:
        """Raise `ValueError` unless the set is a submanifold around x (Def. 1)."""
        if self.functions and rank(self.gradients(x)) < len(self.functions):
            raise ValueError(f"{self._singular}, at {point(x)}")

    @property
    def _singular(self) -> str:
        listed = ", ".join(map(str, self.functions))
        return f"{listed} are not independent where they vanish (Def. 1)"

    def _linear(self, x: Array) -> tuple[Array, Array]:
        """Values, shape (points, codimension), and differentials (..., n) at them."""
        evaluation = WeighedValues(self.state, x)
        values = evaluation(self.functions)
        slopes = evaluation(list(self.differential))
        return values, slopes.reshape(*values.shape, len(self.state))

    def value(self, x: Array) -> Array:
        """The functions at configurations (..., n), shape (..., codimension)."""
        return self._values.values(x)[..., 0]

    def gradients(self, x: Array) -> Array:
        """Gradients at configurations (..., n), shape (..., n, codimension)."""
        if not self.functions:
            return np.zeros((*x.shape, 0))
        return self._gradients.values(x)

    @cached_property
    def _values(self) -> fields.CompiledFields:
        return fields.compile_fields([sp.Matrix(self.functions)], self.state)

    @cached_property
    def _gradients(self) -> fields.CompiledFields:
        slopes = self.differential.T
        columns = [slopes.col(j) for j in range(slopes.cols)]
        return fields.compile_fields(columns, self.state)


def _steepness(slopes: Array) -> Array:
    """The largest slope of each function at sound configurations, (codimension,)."""
    sizes = np.linalg.norm(slopes, axis=-1)
    return np.where(np.isfinite(sizes), sizes, 0.0).max(axis=0, initial=0.0)
