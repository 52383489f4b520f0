"""Flows along the fields of strata, and the lifts and landings between them.

A sequence of flows is in time order. It names strata; how feet get from one stratum to
the next is inserted here from the fields that move foot heights (eq. 12).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from planner.errors import StratumError, unknown
from planner.numerics.arrays import Array
from planner.numerics.collocation import follow
from planner.systems.fields import NumericField, VectorField
from planner.systems.level_sets import LevelSet
from planner.systems.strata import StratifiedSystem, steps


class Flow(NamedTuple):
    """Flow along one field of one stratum for a signed time."""

    stratum: str
    field: str
    duration: float

    def __str__(self) -> str:
        return f"S{self.stratum}: {self.duration:+.6g} {self.field}"


class Word(NamedTuple):
    """Flows of a segment in time order, before they are grouped by stratum.

    Attributes:
        fields: Names of the fields; words of many segments share theirs.
        durations: Their signed durations.
    """

    fields: tuple[str, ...]
    durations: Sequence[float]


def require_flows(system: StratifiedSystem, flows: Sequence[Flow]) -> None:
    """Refuse flows that a system does not have.

    Raises:
        ValueError: A stratum is unknown, or lacks a field, or a time is not finite.
    """
    for stratum, field in dict.fromkeys(flow[:2] for flow in flows):
        if stratum not in system.strata:
            known = unknown(stratum, system.strata)
            raise ValueError(f"flow on stratum {stratum!r}, which {known}")
        if field not in system.fields:
            raise ValueError(f"field {field} {unknown(field, system.fields)}")
        if (owner := system.stratum_of[field]) != stratum:
            raise ValueError(
                f"flow along {field} on S{stratum}; the field belongs to S{owner}"
            )
    for flow in flows:
        if not math.isfinite(flow.duration):
            raise ValueError(f"flow {flow} is not of a finite time")


def merged(flows: Iterable[Flow]) -> tuple[Flow, ...]:
    """Join consecutive flows of one field; those that cancel disappear."""
    joined: list[Flow] = []
    for flow in flows:
        if joined and joined[-1][:2] == flow[:2]:
            flow = flow._replace(duration=joined.pop().duration + flow.duration)
        if flow.duration:
            joined.append(flow)
    return tuple(joined)


def visits(flows: Iterable[Flow]) -> list[list[Flow]]:
    """Maximal runs of flows on one stratum."""
    runs: list[list[Flow]] = []
    for flow in flows:
        if runs and runs[-1][0].stratum == flow.stratum:
            runs[-1].append(flow)
        else:
            runs.append([flow])
    return runs


def contact_switches(
    system: StratifiedSystem, flows: Iterable[Flow], start: str = "", goal: str = ""
) -> int:
    """Commanded lifts plus landings, the first lift and the final landing included.

    Args:
        system: System whose graph of strata says how feet get from one to the next.
        flows: Flows in time order.
        start: Stratum at rest before the first flow; the bottom stratum if empty.
        goal: Stratum at rest after the last one; the bottom stratum if empty.
    """
    walk = [start or system.bottom]
    walk += [run[0].stratum for run in visits(merged(flows))]
    walk += [goal or system.bottom]
    return sum(system.switches(a, b) for a, b in steps(walk))


def flow_map(
    system: StratifiedSystem, name: str, x: Sequence[float] | Array, duration: float
) -> Array:
    """The configuration after flowing along a field, shape (n,)."""
    velocity = system.compiled(name).velocity
    return follow(velocity, np.asarray(x, dtype=float), duration)


def with_lifts(
    system: StratifiedSystem,
    flows: Iterable[Flow],
    height: float,
    start: str = "",
    goal: str = "",
) -> tuple[Flow, ...]:
    """Insert the flows that lift and land feet between strata, as in eq. (12).

    Args:
        system: System with foot heights in its state and fields that move them alone.
        flows: Flows in time order.
        height: Foot height to lift to, in the unit of the level sets.
        start: Stratum at rest before the first flow; the bottom stratum if empty.
        goal: Stratum at rest after the last one; the bottom stratum if empty.

    Raises:
        StratumError: No field moves a foot's height by itself.
    """
    complete: list[Flow] = []
    here = start or system.bottom
    for flow in flows:
        complete += _transition(system, here, flow.stratum, height)
        complete.append(flow)
        here = flow.stratum
    return (*complete, *_transition(system, here, goal or system.bottom, height))


def _transition(
    system: StratifiedSystem, start: str, goal: str, height: float
) -> list[Flow]:
    moves = []
    for here, there in steps(system.route(start, goal)):
        landing = system.contacts[here] < system.contacts[there]
        high = (
            here if landing else there
        )  # a lift field acts where its foot is in the air
        for contact in sorted(system.contacts[here] ^ system.contacts[there]):
            name, rate = lift_field(system, high, contact)
            moves.append(Flow(high, name, (-height if landing else height) / rate))
    return moves


def lift_field(
    system: StratifiedSystem, stratum: str, contact: str
) -> tuple[str, float]:
    """The field that moves one foot's height on a stratum, and its rate.

    It changes the height at a constant rate and no other height that the bottom
    stratum keeps at zero.

    Raises:
        StratumError: There is none.
    """
    heights = system.level_set(system.bottom).functions
    for name, column in system.strata[stratum].items():
        rates = _constant_rates(column, system.level_set(system.bottom))
        moved = [str(h) for h, rate in zip(heights, rates, strict=True) if rate]
        if moved == [contact] and np.isfinite(rates).all():
            return name, float(rates.sum())
    raise StratumError(
        f"no field of S{stratum} moves {contact} alone; give it one, or leave lifts "
        "out of the flows"
    )


def _constant_rates(column: VectorField, heights: LevelSet) -> Array:
    """Rates of the heights along a field where they are constant, else nan."""
    if isinstance(column, NumericField):
        return np.full(len(heights.functions), np.nan)
    rates = heights.differential * column
    return np.array([float(r) if r.is_number else np.nan for r in rates])
