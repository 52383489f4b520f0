"""Creep floor: the slip of a robot that merely stands.

Soft contacts let a loaded foot creep, more slowly as the stresses between the feet
relax. It is measured on a robot that stands for as long as the walk takes.
"""

from __future__ import annotations

import numpy as np

from sim.motion.schedule import Scheduler
from sim.physics.recording import recorded
from sim.preparation.setup import Setup

LONGEST_STAND = 10.0  # [s]


def creep_floor(setup: Setup, duration: float) -> float:
    """Slip of all feet together in a stand that lasts as long as a walk [m].

    Beyond `LONGEST_STAND` it is extrapolated at the rate of its last second, which is
    too much rather than too little.
    """
    stand = min(duration, LONGEST_STAND)
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(setup.limits.hold)
    scheduler.hold(stand)
    schedule = scheduler.finish()
    held, end = (phase.stop for phase in schedule.phases)
    last = min(round(1.0 / setup.limits.timestep), end)
    commands, looks = setup.commands(schedule), np.unique([held, end - last, end])
    recording = recorded(setup.model, setup.robot, commands, end, looks)
    begin, before, after = (
        float(recording.slip_after(step).sum()) for step in (held, end - last, end)
    )
    rate = (after - before) / (last * setup.limits.timestep)
    return after - begin + rate * (duration - stand)
