"""When a motion is looked at: at the end of every phase, and evenly on the way there.

Least margins and clearances are taken over these moments, so they do not depend on
how often states are written down. In between legs swing 0.02 rad: a smooth minimum is
missed by at most a leg's length times half of 0.01 squared, five micrometres.
"""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.motion.schedule import Phase, Schedule

STEP = 0.02  # [rad] that the legs swing at most from one look to the next
LIFTS = 4  # looks at a lift or a landing


def looks(schedule: Schedule) -> Array:
    """Numbers of steps, since the run began, after which to look, shape (L,)."""
    found = [_looks(phase) for phase in schedule.phases]
    return 1 + np.concatenate(found) if found else np.zeros(0, dtype=int)


def _looks(phase: Phase) -> Array:
    samples = LIFTS
    if phase.kind == "swing":
        farthest = abs(phase.amount) * max(map(abs, phase.direction))
        samples = 1 + int(np.ceil(farthest / STEP))
    ends = np.linspace(0, phase.steps - 1, min(samples, phase.steps) + 1)[1:]
    return phase.start + np.unique(ends.round().astype(int))
