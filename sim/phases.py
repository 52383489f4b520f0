"""What happened in each phase of a walk: slip, and whether contacts were as planned."""

from __future__ import annotations

import csv
import io

import numpy as np

from sim.schedule import Phase
from sim.walk import Walk

Array = np.ndarray
COLUMNS = (
    "index", "segment", "start", "end", "kind", "stratum", "field", "amount", "group",
    "slip", "as_planned",
)  # fmt: skip


def phase_slip(walk: Walk, phase: Phase) -> Array:
    """Slip of every foot during a phase, shape (F,) [m]."""
    slip = walk.recording.feet.slip
    before = slip[phase.start - 1] if phase.start else np.zeros(slip.shape[1])
    return np.asarray(slip[phase.stop - 1] - before)


def phase_slips(walk: Walk) -> dict[str, float]:
    """Slip of all feet in each kind of phase, from the start of the walk on [m]."""
    total = dict.fromkeys(("hold", "lift", "swing", "land"), 0.0)
    for phase in walk.phases:
        if phase.start >= walk.starts:
            total[phase.kind] += float(phase_slip(walk, phase).sum())
    return total


def as_planned(walk: Walk, phase: Phase) -> bool:
    """Whether every foot that should stand stood, and every other stayed in the air.

    Feet that are being lifted or landed during the phase are not asked.
    """
    robot = walk.setup.robot
    planned = robot.planted(phase.stratum)
    asked = np.ones(len(planned), dtype=bool)
    if phase.kind in ("lift", "land"):
        asked = ~np.isin(robot.group_of_leg, phase.moving)
    contact = walk.recording.feet.contact[phase.start : phase.stop]
    return bool(
        np.array_equal(contact[:, asked], np.tile(planned[asked], (phase.steps, 1)))
    )


def count_changes(walk: Walk) -> int:
    """Lifts and landings of whole groups during the walk, as measured.

    A group has lifted when its last foot has left the ground, and landed when its last
    foot has touched it.
    """
    contact = walk.recording.feet.contact[walk.starts - 1 :]
    changes = 0
    for group in range(len(walk.setup.robot.groups)):
        feet = contact[:, walk.setup.robot.group_of_leg == group]
        standing = np.where(feet.all(axis=1), 1, np.where(feet.any(axis=1), -1, 0))
        standing = standing[standing >= 0]
        changes += int(np.count_nonzero(np.diff(standing)))
    return changes


def table(walk: Walk) -> str:
    """flows.csv: one line a phase."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(COLUMNS)
    dt, groups = walk.setup.limits.timestep, walk.setup.robot.groups
    for index, p in enumerate(walk.phases):
        writer.writerow(
            (
                index, p.segment, p.start * dt, p.stop * dt, p.kind, p.stratum, p.field,
                p.amount, "".join(groups[i] for i in p.moving),
                float(phase_slip(walk, p).sum()), int(as_planned(walk, p)),
            )
        )  # fmt: skip
    return lines.getvalue()
