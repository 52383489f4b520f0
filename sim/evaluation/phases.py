"""Phases of a walk: their slip, and whether their contacts were as planned."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

import numpy as np

from planner import Array
from sim.motion.schedule import Phase
from sim.walking.finished import Walk

COLUMNS = (
    "index", "segment", "start", "end", "kind", "stratum", "field", "amount", "group",
    "slip", "as_planned",
)  # fmt: skip


def phase_slip(walk: Walk, phase: Phase) -> Array:
    """Slip of every foot during a phase, shape (F,) [m]."""
    recording = walk.recording
    after = recording.slip_after(phase.stop)
    return after - recording.slip_after(phase.start) if phase.start else after


def swing_slip(walk: Walk) -> float:
    """Slip of all feet in all swings [m]."""
    swings = [phase for phase in walk.phases if phase.kind == "swing"]
    return float(sum(phase_slip(walk, phase).sum() for phase in swings))


def as_planned(walk: Walk, phase: Phase) -> bool:
    """Whether the feet in contact were those that were planned.

    All steps of the phase count. Feet that lift off or touch down during the phase are
    left out.
    """
    robot = walk.setup.robot
    planned = robot.planted(phase.stratum)
    asked = np.ones(len(planned), dtype=bool)
    if phase.kind in ("lift", "land"):
        asked = ~np.isin(robot.group_of_leg, phase.moving)
    contact = walk.recording.contacts.between(phase.start + 1, phase.stop)
    return bool((contact[:, asked] == planned[asked]).all())


def moving_time(walk: Walk) -> float:
    """Time from the first lift-off to the last touchdown [s]."""
    moving = [phase for phase in walk.phases if phase.kind != "hold"]
    steps = moving[-1].stop - moving[0].start if moving else 0
    return steps * walk.setup.limits.timestep


def swing_travel(swings: Sequence[Phase], groups: Sequence[str], loaded: bool) -> float:
    """Way of all groups' angles on the ground, or in the air [rad]."""
    return sum(
        abs(phase.amount * phase.direction[i])
        for phase in swings
        for i in phase.moving
        if (groups[i] in phase.stratum) == loaded
    )


def count_changes(walk: Walk) -> int:
    """Number of lift-offs and touchdowns of whole groups during the walk, as measured.

    A group has lifted off when its last foot has left the ground, and touched down when
    its last foot has touched it.
    """
    recording = walk.recording
    contact = recording.contacts.between(walk.starts, recording.steps)
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
