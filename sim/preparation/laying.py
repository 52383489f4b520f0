"""The flows of a plan as phases of a schedule, joined where the field is the same."""

from __future__ import annotations

from collections.abc import Iterable

from planner import Flow
from sim.motion.schedule import Scheduler
from sim.preparation.setup import Setup


def lay(setup: Setup, scheduler: Scheduler, segments: Iterable[Iterable[Flow]]) -> None:
    """Schedule the flows of consecutive segments, and put all feet down at the end."""
    for number, flow in joined(segments, scheduler.segment):
        scheduler.segment = number
        scheduler.flow(flow, setup.equations.swings[flow.field])
    scheduler.enter(setup.robot.card.bottom)


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
