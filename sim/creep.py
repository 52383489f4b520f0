"""How far the feet of a standing robot seem to slip: the floor under every slip.

Soft contacts let a loaded foot creep, ever slower as stresses between the feet relax.
A stand as long as the walk tells how much; long ones are cut off, and their last second
is taken to go on.
"""

from __future__ import annotations

import numpy as np

from sim.measure import Sensors
from sim.physics import Engine
from sim.recording import Recorder
from sim.setup import Setup

LONGEST_STAND = 10.0  # [s]


def creep_floor(setup: Setup, duration: float) -> float:
    """Slip of all feet together in a stand that lasts as long as a walk [m].

    Args:
        setup: Robot, world and timestep.
        duration: From the start of the walk to its end [s]; beyond `LONGEST_STAND` the
            slip is extrapolated at the rate of its last second, which is too much
            rather than too little.
    """
    stand = min(duration, LONGEST_STAND)
    dt, hold = setup.limits.timestep, setup.limits.hold
    recorder = Recorder(
        Engine(setup.model), Sensors(setup.model, setup.robot), 1_000_000
    )
    still = np.zeros((round((hold + stand) / dt), len(setup.robot.groups)))
    for _ in recorder.play(setup.channels.ctrl(still, still)):
        pass
    slip = recorder.finish().feet.slip.sum(axis=1)
    last = min(round(1.0 / dt), len(slip) - 1)
    rate = (slip[-1] - slip[-1 - last]) / (last * dt)
    return float(slip[-1] - slip[round(hold / dt) - 1] + rate * (duration - stand))
