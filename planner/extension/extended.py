"""The stratified extended system on the bottom stratum, eqs. (4), (5) and (15).

Fields of all strata and brackets of them are the columns b_i of one matrix B(x), and
x' = B(x) v (Def. 3). The fictitious inputs v that follow a path come from here;
`extension.steering` turns them into flows.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from planner.errors import PlannerError, RankError, message, point
from planner.extension.fields_on_bottom import on_bottom
from planner.extension.steering import Steering, steering
from planner.numerics.arrays import Array
from planner.numerics.subspaces import column_space
from planner.systems.elements import column, leaves, parse
from planner.systems.fields import CompiledFields, compile_fields, sample_configurations
from planner.systems.grouping import Grouper
from planner.systems.rounding import vanishing
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

CONDITION = 1e9  # number of B(x) beyond which the elements count as dependent
KEPT = 32  # extended systems that later plans find ready
UNREACHED = 1e-6  # relative part of a velocity that the elements may miss


@dataclass(frozen=True, eq=False)
class ExtendedSystem:
    """The extended system x' = B(x) v of eq. (15), a column for each element.

    Attributes:
        system: The stratified system it is built from.
        elements: Names of the elements, p of them.
        columns: The matrix B(x), compiled.
        steering: Hall coordinates and words over the generators of the elements.

    Example:
        >>> import numpy as np
        >>> from planner import EXAMPLES, extend
        >>> extended = extend(EXAMPLES["heisenberg"], ["f", "g", "[f,g]"])
        >>> extended.fictitious_inputs(np.array([1, 0, 0]), np.array([0, 1, 0]))
        array([ 0.,  1., -1.])
    """

    system: StratifiedSystem
    elements: tuple[str, ...]
    columns: CompiledFields
    steering: Steering

    def fictitious_inputs(
        self, x: Array, velocity: Array, units: Array | None = None
    ) -> Array:
        """Inputs v with B(x) v = velocity, eq. (5), of least norm if not unique.

        Configurations x on the bottom stratum and velocities have shape (..., n), the
        inputs (..., p), measured in units (p,) if given. Raises
        `SingularConfigurationError` where a field is not finite, `RankError` where the
        elements do not span, and `PlannerError` if a velocity leaves the stratum.
        """
        matrix = self.columns(x)  # (..., n, p)
        inverse = _inverse(matrix[..., self._moving, :])
        if inverse is None or len(self._moving) != self.system.bottom_dimension:
            units = np.ones(len(self.elements)) if units is None else units
            inputs = self._least_norm(matrix, velocity, x, units)
        else:
            inputs = (inverse @ velocity[..., self._moving, None])[..., 0]
        missed = np.abs((matrix @ inputs[..., None])[..., 0] - velocity)
        allowed = UNREACHED * np.abs(velocity).max(axis=-1, keepdims=True) + 1e-12
        if (missed > allowed).any():
            *where, i = np.unravel_index((missed - allowed).argmax(), missed.shape)
            facts = {"name": self.system.state[i], "bottom": self.system.bottom}
            facts |= {"place": point(x[tuple(where)]), "missed": missed[(*where, i)]}
            raise PlannerError(message("no_element", **facts))
        return inputs

    def to_degree(self, degree: int) -> "ExtendedSystem":
        """The same elements with words that are exact to another degree.

        It is at least the elements' own, and not beyond all use (`ValueError`).
        """
        return self if degree == self.steering.degree else _to_degree(self, degree)

    @cached_property
    def shape(self) -> ShapeCoordinates:
        """Shape coordinates of the system."""
        return ShapeCoordinates(self.system)

    @cached_property
    def grouper(self) -> Grouper:
        """Arrangements of flows by stratum, cached for later plans."""
        return Grouper(self.system, self.steering.hall.commute)

    @cached_property
    def _moving(self) -> Array:
        """Coordinates that some element moves."""
        moving = (self.columns.constant != 0).any(axis=1) | bool(self.columns.numeric)
        moving[[i for i, _ in self.columns.varying]] = True
        return np.flatnonzero(moving)

    def _least_norm(
        self, matrix: Array, velocity: Array, x: Array, units: Array, last: bool = False
    ) -> Array:
        """Inputs of least norm in given units; in others where these hide the rank."""
        rows = self.system.weights[:, None]
        left, singular, right = _decomposed(rows * matrix * units)
        needed = self.system.bottom_dimension
        kept = singular * CONDITION > singular[..., :1]  # (..., min(n, p))
        rank = kept.sum(axis=-1)
        if (rank < needed).any() and not last:
            even = 1.0 / self._sizes(matrix, x)
            return self._least_norm(matrix, velocity, x, even, last=True)
        if (rank < needed).any():
            worst = np.unravel_index(rank.argmin(), rank.shape)
            reached = column_space(left[worst][:, kept[worst]] / rows)
            raise RankError(x[worst], needed, self.system.missing(reached, x[worst]))
        scale = np.where(kept, 1 / np.where(kept, singular, 1.0), 0.0)
        parts = np.swapaxes(left, -1, -2) @ (rows * velocity[..., None])
        return units * (np.swapaxes(right, -1, -2) @ (scale[..., None] * parts))[..., 0]

    def _sizes(self, matrix: Array, x: Array) -> Array:
        """Usual length of each element on a path and near its start, shape (p,).

        A few places where one is singular or vanishes count for nothing.
        """
        weights = self.system.weights
        nearby = sample_configurations(x.shape[-1]) / weights
        near = self.columns.values(x.reshape(-1, x.shape[-1])[0] + nearby)
        every = np.concatenate([matrix.reshape(-1, *matrix.shape[-2:]), near])
        lengths = np.linalg.norm(every * weights[:, None], axis=-2)
        usable = np.where(np.isfinite(lengths) & (lengths > 0.0), lengths, np.nan)
        usable[:, np.isnan(usable).all(axis=0)] = 1.0
        return np.nanmedian(usable, axis=0)

    def orientations(self, x: Array) -> Array:
        """Signs of det B(x), shape (...), if B is square, and ones if it is not.

        Where the sign changes along a path, B(x) is singular in between.
        """
        matrix = self.columns(x)[..., self._moving, :]
        if matrix.shape[-1] != matrix.shape[-2]:
            return np.ones(x.shape[:-1])
        return np.linalg.slogdet(matrix)[0]


def extend(
    system: StratifiedSystem, elements: Iterable[str], degree: int | None = None
) -> ExtendedSystem:
    """The extended system of chosen elements, eqs. (4) and (15).

    Forming and compiling the brackets is the slow part of planning. The result is kept
    with the system, so that later plans have it at once.

    Args:
        system: System whose fields the elements are made of.
        elements: Names as in `systems.elements`, or a `Choice`. Brackets are Hall
            elements over the fields in the order in which these first appear. A field
            that leaves the bottom stratum is replaced by its tangent part (Sec. 5.1).
        degree: Degree of the nilpotent approximation. Brackets up to that degree are
            realised, not those among the elements alone. The highest degree of the
            elements if not given.

    Raises:
        ValueError: An element is unknown, repeated or not a Hall element, or the
            degree is below that of an element or beyond all use.
        PlannerError: An element vanishes everywhere, cannot be made tangent to the
            bottom stratum, or does not commute with the lift fields (eq. 13).

    Example:
        >>> from planner import EXAMPLES, extend
        >>> extend(EXAMPLES["heisenberg"], ["f", "g", "[f,g]"]).columns((1, 0, 0))
        array([[1., 0., 0.],
               [0., 1., 0.],
               [0., 1., 1.]])
    """
    if isinstance(elements, str):
        raise ValueError(f"elements is the text {elements!r}; give a sequence of names")
    return _extended(system, tuple(elements), degree)


@lru_cache(maxsize=KEPT)
def _extended(
    system: StratifiedSystem, elements: tuple[str, ...], degree: int | None
) -> ExtendedSystem:
    trees = [parse(text, system) for text in elements]
    system, trees = on_bottom(system, trees)
    names = tuple(map(str, trees))
    if not names:
        raise ValueError(message("no_elements"))
    if twice := [*Counter(names) - Counter({*names})]:
        raise ValueError(f"element {twice[0]} is listed twice; keep one")
    columns = [column(tree, system) for tree in trees]
    zeros = vanishing(columns, system.state)
    for name, tree, zero in zip(names, trees, zeros, strict=True):
        if zero:
            reason = "its fields commute" if len(leaves(tree)) > 1 else "it is zero"
            raise PlannerError(f"element {name} vanishes everywhere: {reason}; drop it")
    compiled = compile_fields(columns, system.state, names)
    return ExtendedSystem(system, names, compiled, steering(system, trees, degree))


@lru_cache(maxsize=KEPT)
def _to_degree(extended: ExtendedSystem, degree: int) -> ExtendedSystem:
    trees = [parse(text, extended.system) for text in extended.elements]
    return replace(extended, steering=steering(extended.system, trees, degree))


def _inverse(matrix: Array) -> Array | None:
    """Inverses of square matrices; None if one of them is ill-conditioned."""
    if matrix.shape[-1] != matrix.shape[-2]:
        return None
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return None
    sizes = [np.linalg.norm(each, np.inf, axis=(-2, -1)) for each in (matrix, inverse)]
    return inverse if bool((sizes[0] * sizes[1] < CONDITION).all()) else None


def _decomposed(matrix: Array) -> tuple[Array, Array, Array]:
    """Singular value decompositions; of equal matrices in a row it is computed once."""
    flat = matrix.reshape(-1, *matrix.shape[-2:])
    new = np.append(True, (flat[1:] != flat[:-1]).any(axis=(-2, -1)))[: len(flat)]
    parts = np.linalg.svd(flat[new], full_matrices=False)
    repeated = np.cumsum(new) - 1
    left, singular, right = (
        part[repeated].reshape(*matrix.shape[:-2], *part.shape[1:]) for part in parts
    )
    return left, singular, right
