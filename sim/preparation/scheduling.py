"""The flows of a plan as phases of a schedule, joined where the field is the same.

Recoveries take place during strokes where the scenario asks for it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby

import numpy as np

from planner import Flow
from planner.systems import gait_steps
from sim.motion.schedule import LegState, Schedule, Scheduler
from sim.preparation.setup import Setup

Move = tuple[int, Flow, tuple[float, ...]]


def schedule_flows(
    setup: Setup, scheduler: Scheduler, segments: Iterable[Iterable[Flow]]
) -> None:
    """Schedule the flows of consecutive segments, and put all feet down at the end.

    Where the scenario has a gait, its strata are entered in turn, also those on which
    nothing flows.
    """
    moves = [
        (number, flow, setup.equations.swings[flow.field])
        for number, flow in joined(segments, scheduler.segment)
    ]
    if setup.scenario.overlap_recovery:
        moves = overlapped(moves, setup.robot.groups)
    bottom, gait = setup.robot.card.bottom, setup.scenario.gait
    flows = [flow for _, flow, _ in moves]
    entered: Sequence[tuple[str, ...]] = [*((f.stratum,) for f in flows), (bottom,)]
    if gait:
        system = setup.equations.system
        entered = gait_steps(system, flows, gait, (bottom, bottom))
    *before, after = entered
    for strata, (number, flow, direction) in zip(before, moves, strict=True):
        scheduler.segment = number
        for stratum in strata:
            scheduler.enter(stratum)
        scheduler.flow(flow, direction)
    for stratum in after:
        scheduler.enter(stratum)


def scheduled(
    setup: Setup,
    segments: Iterable[Iterable[Flow]],
    begin: LegState | None = None,
    segment: int = 0,
) -> Schedule:
    """The commands of segments alone, from a state of the legs, by default at rest."""
    scheduler = Scheduler(setup.limits, begin or setup.at_rest, segment=segment)
    schedule_flows(setup, scheduler, segments)
    return scheduler.finish()


def overlapped(moves: Sequence[Move], groups: Sequence[str]) -> list[Move]:
    """The same moves, with legs in the air recovering while others stroke.

    A stay on one stratum takes as long as its strokes, or as its recoveries if these
    are longer: each stroke takes along a share of the recoveries that is its own share
    of the strokes. Nothing changes but the time, as a leg in the air moves no body.
    """
    done: list[Move] = []
    for _, stay in groupby(moves, key=lambda move: move[1].stratum):
        done += _shared(list(stay), groups)
    return done


def _shared(stay: list[Move], groups: Sequence[str]) -> list[Move]:
    """The moves of one stay, recoveries shared out among the strokes."""

    def loaded(move: Move) -> bool:
        _, flow, direction = move
        swinging = zip(groups, direction, strict=True)
        return any(share and group in flow.stratum for group, share in swinging)

    strokes = [move for move in stay if loaded(move)]
    recoveries = [move for move in stay if not loaded(move)]
    if not (strokes and recoveries):
        return stay
    ways = np.array([np.multiply(flow.duration, d) for _, flow, d in recoveries])
    lengths = [abs(flow.duration) * max(map(abs, d)) for _, flow, d in strokes]
    shared = []
    for (number, flow, direction), length in zip(strokes, lengths, strict=True):
        along = ways.sum(axis=0) * (length / sum(lengths) / flow.duration)
        both = tuple((np.array(direction) + along).tolist())
        shared.append((number, flow, both))
    return shared


def joined(
    segments: Iterable[Iterable[Flow]], first: int = 0
) -> list[tuple[int, Flow]]:
    """Flows with their segments; consecutive flows of one field become one.

    A flow that continues in the next segment belongs to the segment it starts in.
    """
    done: list[tuple[int, Flow]] = []
    for number, flows in enumerate(segments, start=first):
        for flow in flows:
            begun = number
            if done and done[-1][1][:2] == flow[:2]:
                begun, before = done.pop()
                flow = flow._replace(duration=before.duration + flow.duration)
            if flow.duration:
                done.append((begun, flow))
    return done
