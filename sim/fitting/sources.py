"""What is fitted: logs from files, and walks from their folders as such logs."""

from __future__ import annotations

import numpy as np

from models.description import actuator_of
from sim.logs.log import Log
from sim.runs.run import Run
from sim.world.dead_bands import BAND
from sim.world.imperfections import BACKLASH


def log_of(run: Run) -> Log:
    """A walk as the log of a robot that was told what it was, and seen without noise.

    A leg's angle is the sum of the joints that dead band and backlash make of one.
    """
    rows, model, joints = run.walking, run.model, run.card.joints
    named = {model.joint(j).name: int(model.jnt_qposadr[j]) for j in range(model.njnt)}
    angles = [
        run.qpos[rows][:, [named[n] for n in _parts(joint) if n in named]].sum(axis=1)
        for joint in joints
    ]
    servos = [actuator_of(model, joint) for joint in joints]
    time = run.time[rows]
    return Log(
        time=time - time[0],
        joints=joints,
        commanded=run.ctrl[rows][:, servos],
        measured=np.stack(angles, axis=1),
        pose=run.achieved[rows],
    )


def _parts(joint: str) -> tuple[str, str, str]:
    return joint, BAND + joint, BACKLASH + joint
