"""Choose the elements of an extended system, and give the reasons (Def. 3).

The elements span the tangent space of the bottom stratum at given configurations. Low
degree comes first, then few contact switches, then distance from linear dependence.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice, pairwise, product

import numpy as np
from numpy.typing import ArrayLike

from planner.errors import PlannerError, RankError, SingularConfigurationError, message
from planner.extension.bracket_fields import hall_fields
from planner.extension.fields_on_bottom import on_bottom
from planner.lie.input_words import letters_of
from planner.numerics.arrays import Array
from planner.numerics.subspaces import column_space, in_words
from planner.support.stopping import tick
from planner.systems.closure import involutive_closure
from planner.systems.elements import leaves, parse_names
from planner.systems.fields import VectorField
from planner.systems.rounding import WeighedValues
from planner.systems.strata import StratifiedSystem

ALIKE = 9  # digits to which two elements count as equally far from dependence


@dataclass(frozen=True)
class Choice:
    """Chosen elements by name, and the reasons for each; iterates over the names."""

    elements: tuple[str, ...]
    condition: float  # largest condition number of B(x) at the configurations
    reasons: tuple[str, ...]  # one sentence for each element

    def __iter__(self) -> Iterator[str]:
        return iter(self.elements)

    def __str__(self) -> str:
        return "\n".join([*self.reasons, f"condition number {self.condition:.3g}"])


@dataclass(frozen=True, eq=False)
class _Candidate:
    """An element that might be chosen."""

    name: str
    degree: int
    switches: int  # of contacts in its word, from the bottom stratum and back
    values: Array  # at the configurations, shape (k, n)
    columns: Array  # the same as unit vectors, in units that suit all coordinates

    def measured(self, units: Array) -> "_Candidate":
        """The same element in given units of the coordinates, shape (n,)."""
        scaled = self.values / units
        lengths = np.linalg.norm(scaled, axis=-1, keepdims=True)
        return replace(self, columns=scaled / np.where(lengths > 0, lengths, 1.0))

    def beyond(self, spans: Sequence[Array]) -> Array:
        """The component orthogonal to each span, shape (k, n)."""
        parts = [c - Q @ (Q.T @ c) for c, Q in zip(self.columns, spans, strict=True)]
        return np.array(parts)


def choose_elements(
    system: StratifiedSystem, at: ArrayLike, max_degree: int = 4
) -> Choice:
    """Elements that span the bottom stratum's tangent space at given configurations.

    Brackets of few fields are tried before brackets of all fields. The configurations
    are on the bottom stratum, shape (n,) or (k, n).

    Raises:
        RankError: No elements up to that degree span it.
        ValueError: The configurations are misshapen, or the degree is below 1.
        SingularConfigurationError: A field is not finite at one of them.

    Example:
        >>> from planner import EXAMPLES, choose_elements
        >>> choose_elements(EXAMPLES["heisenberg"], at=(0, 0, 0)).elements
        ('f', 'g', '[f,g]')
    """
    x = np.atleast_2d(np.asarray(at, dtype=float))
    if x.ndim != 2 or x.shape[1] != system.dimension:
        raise ValueError(message("shaped", shape=x.shape, size=system.dimension))
    if max_degree < 1:
        raise ValueError(f"max_degree is {max_degree}; fields themselves have degree 1")
    usable = _usable_fields(system)
    fields = _even(_candidates(system, usable.items(), x))
    few = _enlarged([], fields, system, x)
    independent = involutive_closure(usable, system.state, x[0], max_depth=1).names
    spanning = [field for field in fields if field.name in independent]
    for first, degree in product((few, spanning), range(1, max_degree + 1)):
        hall = hall_fields(system, [candidate.name for candidate in first], degree)
        every = zip(hall.names, hall.fields, strict=True)
        brackets = _candidates(system, islice(every, len(first), None), x)
        even = _even([*fields, *brackets])
        begun = [c for f in first for c in even if c.name == f.name]
        chosen = _enlarged(begun, even[len(fields) :], system, x)
        if min(Q.shape[1] for Q in _spans(chosen, x)) == system.bottom_dimension:
            return _choice(system, chosen, x)
    plain = [c.measured(1.0 / system.weights) for c in chosen]
    spans = _spans(plain, x)  # each configuration for itself
    ranks = [Q.shape[1] for Q in spans]
    worst = int(np.argmin(ranks))
    if ranks[worst] == system.bottom_dimension:
        return _choice(system, chosen, x)
    reached = column_space(spans[worst] / system.weights[:, None])
    needed = system.bottom_dimension
    more = involutive_closure(usable, system.state, x[worst], 2 * max_degree, needed)
    enough = more.depth if more.rank == needed else None
    raise RankError(x[worst], needed, system.missing(reached, x[worst]), enough)


@lru_cache(maxsize=32)
def _usable_fields(system: StratifiedSystem) -> Mapping[str, VectorField]:
    """Fields that are tangent to the bottom stratum without correction."""
    usable: dict[str, VectorField] = {}
    for name, field in system.fields.items():
        with suppress(PlannerError):
            if on_bottom(system, [name])[0] is system:
                usable[name] = field
    return usable


def _candidates(
    system: StratifiedSystem, fields: Iterable[tuple[str, VectorField]], x: Array
) -> list[_Candidate]:
    evaluation = WeighedValues(system.state, x)
    candidates = []
    for name, field in fields:
        column = evaluation(field)
        if not (sound := np.isfinite(column).all(axis=1)).all():
            raise SingularConfigurationError(name, x[~sound][0])
        tree = parse_names(name)
        word = [system.stratum_of[field_name] for field_name, _ in letters_of(tree)]
        walk = pairwise([system.bottom, *word, system.bottom])
        switches = sum(system.switches(a, b) for a, b in walk)
        candidates.append(_Candidate(name, len(leaves(tree)), switches, column, column))
    return candidates


def _even(candidates: Sequence[_Candidate]) -> list[_Candidate]:
    """Candidates in units in which all coordinates and elements are of equal size.

    Other units of the state or of the fields then change nothing. The logarithms of the
    units are those that leave the least squares of the logarithms of all values.
    """
    if not candidates:
        return []
    sizes = np.max([np.abs(c.values) for c in candidates], axis=1).T  # (n, candidates)
    row, column = np.nonzero(sizes)
    unknown = np.zeros((len(row), sum(sizes.shape)))
    unknown[np.arange(len(row)), row] = 1.0
    unknown[np.arange(len(row)), len(sizes) + column] = 1.0
    logarithms, *_ = np.linalg.lstsq(unknown, np.log(sizes[row, column]), rcond=None)
    units = np.exp(logarithms[: len(sizes)])
    return [candidate.measured(units) for candidate in candidates]


def _spans(chosen: Sequence[_Candidate], x: Array) -> list[Array]:
    """Orthonormal columns of the span of chosen elements, at each configuration."""
    if not chosen:
        return [np.empty((x.shape[1], 0))] * len(x)
    columns = np.stack([candidate.columns for candidate in chosen], axis=-1)
    return [column_space(c) for c in columns]


def _enlarged(
    chosen: Sequence[_Candidate],
    candidates: Sequence[_Candidate],
    system: StratifiedSystem,
    x: Array,
) -> list[_Candidate]:
    """Add candidates, the best first, until they span or no candidate helps."""
    chosen = list(chosen)
    while True:
        tick()
        spans = _spans(chosen, x)
        lacking = [Q.shape[1] < system.bottom_dimension for Q in spans]
        gains = [np.linalg.norm(c.beyond(spans), axis=1)[lacking] for c in candidates]
        useful = [
            (c.degree, c.switches, -round(float(gain.mean()), ALIKE), i)
            for i, (c, gain) in enumerate(zip(candidates, gains, strict=True))
            if gain.max(initial=0) > 0.05  # sine of its angle with the span
        ]
        if not useful:
            return chosen
        chosen.append(candidates[min(useful)[-1]])


def _choice(system: StratifiedSystem, chosen: Sequence[_Candidate], x: Array) -> Choice:
    reasons = []
    for k, candidate in enumerate(chosen):
        added = candidate.beyond(_spans(chosen[:k], x))
        most = added[np.linalg.norm(added, axis=1).argmax()]  # where it adds most
        way = np.round(most / (np.abs(most).max() or 1.0), 3)
        adds = in_words(way, system.state) or "nothing but brackets"
        reasons.append(message("adds", element=candidate, adds=adds))
    plain = [candidate.measured(np.ones(x.shape[1])) for candidate in chosen]
    matrices = np.stack([candidate.columns for candidate in plain], axis=-1)
    singular = np.linalg.svd(matrices, compute_uv=False)
    condition = (singular[:, 0] / singular[:, system.bottom_dimension - 1]).max()
    return Choice(tuple(c.name for c in chosen), float(condition), tuple(reasons))
