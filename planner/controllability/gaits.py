"""Gait controllability (Sec. 4): does a gait reach all directions of its first stratum?

There are two tests at a configuration. The first is the filtration of the paper: the
involutive closures of the strata are added when a foot lifts, and intersected with
tangent spaces when a foot lands. It never brackets fields of different strata, so it is
sufficient but not necessary. The second is the involutive closure of all fields of the
gait's strata that are tangent to the first one, as the extended system of Def. 3.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from planner.errors import message, point
from planner.extension.fields_on_bottom import coupled, lifts, tangent_field
from planner.numerics.arrays import Array
from planner.numerics.subspaces import (
    SPANNED,
    column_space,
    nearly_dependent,
    null_space,
    rank,
)
from planner.systems.closure import LieClosure, exact_rank, involutive_closure
from planner.systems.fields import NumericField, VectorField
from planner.systems.flows import Gait
from planner.systems.level_sets import LevelSet
from planner.systems.strata import StratifiedSystem

OFF_STRATUM = 1e-9  # by which a configuration may miss the level sets
MAX_DEPTH = 12


@dataclass(frozen=True)
class Controllability:
    """Result of the two tests of gait controllability (Sec. 4).

    Attributes:
        gait: The gait as text.
        at: Configuration of the test.
        controllable: Whether one of the tests reaches the whole tangent space.
        conclusive: Whether the answer is final. It is not if higher brackets, fields
            that are nearly dependent, or lift fields to which Assumption 2 does not
            apply could change it.
        rank: The larger of the two dimensions reached.
        dimension: Dimension of the gait's first stratum.
        filtration: Dimension that the filtration reaches.
        closure: Dimension that the closure reaches.
        decided_by: `filtration` or `closure`, whichever reaches it first, or `neither`.
        depth: Highest degree of brackets that was formed.
        missing: Directions that are not reached, as text; empty if controllable.
        advice: What would help; empty if controllable.

    Example:
        >>> from planner import EXAMPLES, gait_controllability
        >>> walker, gait = EXAMPLES["walker"], ("12", "1", "12")
        >>> found = gait_controllability(walker, gait, at=(0, 0, 0))
        >>> found.controllable, found.missing
        (False, ('y', 'z'))
    """

    gait: str
    at: tuple[float, ...]
    controllable: bool
    conclusive: bool
    rank: int
    dimension: int
    filtration: int
    closure: int
    decided_by: str
    depth: int
    missing: tuple[str, ...]
    advice: tuple[str, ...]

    def __str__(self) -> str:
        tests = (
            f"filtration {self.filtration}, closure {self.closure} of {self.dimension} "
            f"with brackets to degree {self.depth}"
        )
        if self.controllable:
            verdict = f"controllable by {self.decided_by}"
            return f"{self.gait} at {point(self.at)} is {verdict}: {tests}"
        verdict = "is not" if self.conclusive else "has not been shown to be"
        return (
            f"{self.gait} at {point(self.at)} {verdict} controllable: {tests}; "
            f"no motion along {', '.join(self.missing)}; {'; or '.join(self.advice)}"
        )


def gait_controllability(
    system: StratifiedSystem,
    gait: Sequence[str],
    at: Sequence[float],
    max_depth: int = MAX_DEPTH,
) -> Controllability:
    """Whether a gait is controllable from a configuration (Sec. 4).

    A gait lists strata in order, the first again at the end (eq. 11). The first has the
    configuration (n,). Brackets are formed to the highest degree given, if no lower
    degree decides.

    Raises:
        StratumError: The gait is not a closed walk in the graph of strata.
        ValueError: The configuration is misshapen, or not in the first stratum.
        SingularConfigurationError: A field is not finite there.

    Example:
        >>> from planner import EXAMPLES, gait_controllability
        >>> gait = ("12", "1", "12", "2", "12")
        >>> found = gait_controllability(EXAMPLES["walker"], gait, at=(0, 0, 0))
        >>> found.controllable, found.decided_by, found.rank, found.dimension
        (True, 'closure', 3, 3)
    """
    walk = Gait(system, tuple(gait))
    first = walk.strata[0]
    home = system.level_set(first)
    x = _placed(system, home, at)
    dimension = system.dimension_of(first)
    algebras = {
        name: involutive_closure(
            system.strata[name], system.state, x, max_depth, system.dimension_of(name)
        )
        for name in dict.fromkeys(walk.strata)
    }
    filtered = _filtration(system, walk, algebras, x)
    union, tangent = algebras[first], _tangent_fields(system, walk.strata, first)
    if len(algebras) > 1:
        union = involutive_closure(tangent, system.state, x, max_depth, dimension)
    closed = column_space(union.columns)
    if max(filtered.shape[1], closed.shape[1]) < dimension:
        every = [*tangent.values(), *union.fields]
        if (exact_rank(every, system.state, x) or 0) >= dimension:
            closed = null_space(home.gradients(x).T)
    reached = max(filtered, closed, key=lambda space: space.shape[1])
    controllable = reached.shape[1] == dimension
    missing = unjudged = advice = tuple[str, ...]()
    if not controllable:
        missing = system.missing(reached, x, first)
        unjudged = _unjudged(system, walk.strata, union)
        advice = (*unjudged, *_advice(system, walk, x, union, max_depth, missing))
    tests = {"filtration": filtered.shape[1], "closure": closed.shape[1]}
    return Controllability(
        gait=str(walk),
        at=tuple(x.tolist()),
        controllable=controllable,
        conclusive=controllable or (union.complete and not unjudged),
        rank=reached.shape[1],
        dimension=dimension,
        **tests,
        decided_by=next((t for t in tests if tests[t] == dimension), "neither"),
        depth=max(union.depth, *(algebra.depth for algebra in algebras.values())),
        missing=missing,
        advice=advice,
    )


def _placed(system: StratifiedSystem, home: LevelSet, at: Sequence[float]) -> Array:
    x = np.asarray(at, dtype=float)
    if x.shape != (system.dimension,):
        state = ", ".join(map(str, system.state))
        facts = {"shape": x.shape, "dimension": system.dimension, "state": state}
        raise ValueError(message("configuration", **facts))
    if not np.isfinite(x).all():
        raise ValueError(f"configuration {point(x)} is not finite")
    if home.functions and (missed := np.abs(home.value(x))).max() > OFF_STRATUM:
        function = home.functions[missed.argmax()]
        raise ValueError(message("not_home", place=point(x), function=function))
    home.require_regular(x)
    return x


def _filtration(
    system: StratifiedSystem, walk: Gait, algebras: dict[str, LieClosure], x: Array
) -> Array:
    """The distribution D_{n+1} of Sec. 4, numbered as eq. (11) is, as columns."""
    space = column_space(algebras[walk.strata[0]].columns)
    for before, here in pairwise(walk.strata):
        level_set = system.level_set(here)
        if system.contacts[before] < system.contacts[here] and level_set.functions:
            slopes = column_space(level_set.gradients(x)).T @ space  # (codim, rank)
            space = space @ null_space(slopes)  # its part in the tangent space
        space = column_space(np.hstack([space, algebras[here].columns]))
    return space


def _tangent_fields(
    system: StratifiedSystem, strata: Iterable[str], home: str
) -> dict[str, VectorField]:
    """Fields of strata that can be made tangent to the home stratum."""
    return {
        name: field
        for stratum in dict.fromkeys(strata)
        for name in system.strata[stratum]
        if (field := tangent_field(system, name, home)) is not None
    }


def _unjudged(
    system: StratifiedSystem, strata: Sequence[str], union: LieClosure
) -> tuple[str, ...]:
    """Advice on what the closure cannot decide; none if Assumption 2 holds."""
    home, *others = dict.fromkeys(strata)
    advice = []
    if nearly_dependent(union.columns) or _depends_on_units(union):
        advice.append(f"make fields differ by more than {SPANNED:.0e} of their size")
    for stratum in others:
        held = _tangent_fields(system, [stratum], home)
        raised = {name: system.fields[name] for name in lifts(system, stratum, home)}
        advice += [
            f"let a lift of S{stratum} hold {name} on S{home}"
            for name in system.strata[stratum]
            if name not in held | raised
        ]
        advice += [
            f"make {name} independent of what {lift} lifts (eq. 13)"
            for lift, name in coupled(system, raised, held | raised)
        ]
    return tuple(advice)


def _depends_on_units(union: LieClosure) -> bool:
    """Whether the rank is larger in units in which all coordinates move alike."""
    if any(isinstance(field, NumericField) for field in union.fields):
        return False  # rates that should be zero are differences' errors
    sizes = np.abs(union.columns).max(axis=1, keepdims=True, initial=0.0)
    return rank(union.columns / np.where(sizes > 0.0, sizes, 1.0)) > union.rank


def _advice(
    system: StratifiedSystem,
    walk: Gait,
    x: Array,
    union: LieClosure,
    max_depth: int,
    missing: Sequence[str],
) -> tuple[str, ...]:
    """Advice: a further stratum, a higher degree, or another field."""
    advice, home = list[str](), walk.strata[0]
    for stratum in system.strata:
        if stratum not in walk.strata:
            tangent = _tangent_fields(system, (*walk.strata, stratum), home)
            size = system.dimension_of(home)
            wider = involutive_closure(tangent, system.state, x, union.depth, size)
            if wider.rank > union.rank:
                advice.append(f"visit S{stratum}")
    if not union.complete and union.depth == max_depth:
        advice.append(f"form brackets beyond degree {max_depth}")
    elif not union.complete:
        advice.append(f"simplify the fields: too large beyond degree {union.depth}")
    return (*advice, f"give some stratum a field that moves along {missing[0]}")
