"""The steps of a motion after which its state is inspected.

Every phase is inspected at its end and at even distances before it. The least margins
and clearances of a walk are taken over these inspections, so that they do not depend
on how often states are recorded. The legs swing by at most 0.02 rad from one inspection
to the next; a smooth minimum is therefore missed by at most the length of a leg times
half of 0.01 squared, which is five micrometres.
"""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.motion.schedule import Phase, Schedule

STEP = 0.02  # [rad] that the legs swing at most between inspections
LIFTS = 4  # inspections of a lift-off or touchdown


def inspections(schedule: Schedule) -> Array:
    """Steps, counted from the start of the run, to inspect the state after, (L,)."""
    found = [_of_phase(phase) for phase in schedule.phases]
    return 1 + np.concatenate(found) if found else np.zeros(0, dtype=int)


def _of_phase(phase: Phase) -> Array:
    samples = LIFTS
    if phase.kind == "swing":
        farthest = abs(phase.amount) * max(map(abs, phase.direction))
        samples = 1 + int(np.ceil(farthest / STEP))
    ends = np.linspace(0, phase.steps - 1, min(samples, phase.steps) + 1)[1:]
    return phase.start + np.unique(ends.round().astype(int))
