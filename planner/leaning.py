"""Lean before a foot lifts, and straighten up after it has landed.

Where lifting a foot would tip the robot, it first flows along a field of the bottom
stratum for some time, and back along it afterwards. If that field commutes with what
the foot does in the air the two cancel, so the motion as a whole is what it was.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from planner.errors import StratumError
from planner.flows import Flow, merged
from planner.strata import StratifiedSystem

Leans = Mapping[str, tuple[str, float]]
"""For each stratum to lean on the field to lean along and for how long."""


def leaning(
    system: StratifiedSystem,
    segments: Sequence[Sequence[Flow]],
    leans: Leans,
    commute: Callable[[str, str], bool],
) -> list[list[Flow]]:
    """The same motion, leaning on some strata.

    Args:
        system: System that the flows are of.
        segments: Flows of each segment in time order.
        leans: Where, along what and how far to lean.
        commute: Whether two fields' flows may be interchanged.

    Raises:
        StratumError: A lean does not commute with a flow that it embraces.
    """
    ordered: list[list[Flow]] = []
    now: dict[str, float] = {}  # duration by field of the current lean
    for flows in segments:
        out: list[Flow] = []
        for flow in flows:
            wanted = _wanted(leans, flow, commute)
            out += _change(system, now, wanted)
            out.append(flow)
            now = wanted
        ordered.append(out)
    if ordered:
        ordered[-1] += _change(system, now, {})
    return [list(merged(flows)) for flows in ordered]


def _wanted(
    leans: Leans, flow: Flow, commute: Callable[[str, str], bool]
) -> dict[str, float]:
    if flow.stratum not in leans:
        return {}
    field, duration = leans[flow.stratum]
    if not commute(field, flow.field):
        raise StratumError(
            f"leaning along {field} on S{flow.stratum} changes what {flow.field} does; "
            "the two must commute"
        )
    return {field: duration}


def _change(
    system: StratifiedSystem, now: Mapping[str, float], then: Mapping[str, float]
) -> Iterator[Flow]:
    for field in dict.fromkeys((*now, *then)):
        if change := then.get(field, 0.0) - now.get(field, 0.0):
            yield Flow(system.stratum_of[field], field, change)
