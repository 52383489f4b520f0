"""Phases of a walk: their slip, and whether their contacts were as planned."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from planner import Array
from sim.compliant.prediction import CompliantPrediction
from sim.evaluation.flows import WalkedPhase
from sim.evaluation.summary import Departed, Predicted, Real
from sim.logs.alignment import Measured
from sim.motion.poses import lean_of
from sim.motion.prediction import Prediction
from sim.motion.schedule import Phase
from sim.scenarios.predictions import PREDICTIONS
from sim.walking.finished import Walk
from sim.world.imperfections import BACKLASH, turned


def phase_slip(walk: Walk, phase: Phase) -> Array:
    """Slip of every foot during a phase, shape (F,) [m]."""
    after = walk.recording.slip_after(phase.stop)
    return after - walk.recording.slip_after(phase.start) if phase.start else after


def standing_slip(walk: Walk, slip: Array | None = None) -> Array:
    """Slip of every foot while it was planned to stand and legs swung, (F,) [m].

    It is that of the physics, or of a prediction with slip (T, F). What feet slip while
    others lift and land does not move the body.
    """
    moments = walk.recording.moments
    total = moments.slip if slip is None else slip
    robot = walk.setup.robot
    stood = np.zeros(len(robot.legs))
    for phase in walk.phases:
        if phase.kind == "swing":
            begin, end = moments.step.searchsorted([phase.start, phase.stop])
            stood += (total[end] - total[begin]) * phase.planted(robot)
    return stood


def slip_by_phase(walk: Walk, slip: float, in_swings: float) -> dict[str, float | None]:
    """Slip in swings and beside them [m]; a motion that is played has no phases."""
    parts = (in_swings, slip - in_swings) if walk.setup.motion is None else (None, None)
    return dict(zip(("slip_swing", "slip_transition"), parts, strict=True))


def foreseen(
    walk: Walk, name: str, prediction: Prediction, judged: Array, clear: float | None
) -> Predicted:
    """What a prediction says of a whole walk; `clear` of obstacles [m]."""
    return Predicted(
        pose=prediction.pose[-1].tolist(),
        min_margin=float(prediction.margin[judged].min()),
        slip=float(prediction.slip[-1].sum()),
        min_clearance=clear,
        ignores=PREDICTIONS[name].ignored(walk.setup.scenario),
        **_foresight(walk, prediction),
    )


def _foresight(walk: Walk, prediction: Prediction) -> dict[str, Any]:
    """What a prediction says of slip by phase, and when feet first let go [s], if ever.

    A foot lets go where it bears no load for a while, though it should as legs swing.
    """
    if not isinstance(prediction, CompliantPrediction):
        return {}
    step, dt = walk.recording.moments.step, walk.setup.limits.timestep
    swings = [(p.start, p.stop) for p in walk.phases if p.kind == "swing"]
    edges = step.searchsorted(swings).reshape(-1, 2)
    total = prediction.slip.sum(axis=1)
    in_swings = float(np.diff(total[edges]).sum())
    swung = np.zeros(len(step), dtype=bool)
    for begin, end in edges:
        swung[begin + 1 : end + 1] = True
    idle = prediction.contact & ~prediction.standing & swung[:, None]
    lasting = idle[2:] & idle[1:-1] & idle[:-2]
    legs = zip(walk.setup.robot.legs, lasting.T, strict=True)
    return {
        **slip_by_phase(walk, float(total[-1]), in_swings),
        "lets_go": {
            str(leg): float(step[at.argmax()] * dt) for leg, at in legs if at.any()
        },
    }


def as_planned(walk: Walk, phase: Phase) -> bool:
    """Whether feet that neither lift nor land were in contact as planned throughout."""
    robot = walk.setup.robot
    changing = phase.moving if phase.kind in ("lift", "land") else ()
    asked = ~np.isin(robot.group_of_leg, changing)
    contact = walk.recording.contacts.between(phase.start + 1, phase.stop)
    return bool((contact[:, asked] == phase.planted(robot)[asked]).all())


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


def real_robot(walk: Walk, real: Measured | None) -> Real | None:
    """What was measured on a real robot, and how the simulated one is unlike it."""
    motion, moments = walk.setup.motion, walk.recording.moments
    if motion is None or real is None:
        return None
    log, model, robot = motion.log, walk.setup.model, walk.setup.robot
    time = (moments.step - walk.starts) * walk.setup.limits.timestep
    on = (time >= 0) & (time <= log.duration)
    joints = contact = None
    lean = lean_of(moments.qpos[on], robot.root_address_in(model))
    simulated = dict(zip(("roll", "pitch"), (lean - lean[0]).T, strict=True))
    if log.measured is not None:
        angles = turned(model, moments.qpos[on], log.joints, BACKLASH)
        found = [np.interp(log.time, time[on], angle) for angle in angles.T]
        apart = np.stack(found, axis=1) - log.measured  # at the rows of the log
        known = apart[np.isfinite(apart)]
        joints = float(np.sqrt(np.mean(known**2))) if len(known) else None
    if log.contact:
        rows = np.clip(log.time.searchsorted(time[on]), 0, len(log.time) - 1)
        told = np.stack([log.contact[leg][rows] for leg in log.contact], axis=1)
        legs = [robot.legs.index(leg) for leg in log.contact]
        alike = (moments.contact[on][:, legs] == (told > 0))[np.isfinite(told)]
        contact = float(np.mean(alike)) if len(alike) else None
    return Real(
        pose=None if real.pose is None else real.pose[-1].tolist(),
        spread=None if real.spread is None else real.spread[-1].tolist(),
        **{k: _departed(angle[on], simulated[k]) for k, angle in real.lean.items()},
        joints=joints,
        contact=contact,
        done=[*log.done, *real.done],
    )


def _departed(measured: Array, simulated: Array) -> Departed:
    """An angle (T,) of a real robot, and of the simulated one."""
    off = np.abs(simulated - measured)
    end, off_there, farthest = map(float, (measured[-1], off[-1], off.max()))
    return Departed(end=end, off=off_there, farthest=farthest)


def commanded_pace(walk: Walk) -> tuple[int, float]:
    """Contact switches, and the fastest swing of a leg [rad/s], as commanded."""
    if (motion := walk.setup.motion) is not None:
        planned = np.vstack([motion.low, motion.contact])
        speed = np.diff(motion.log.commanded, axis=0).T / np.diff(motion.log.time)
        legs = walk.setup.robot.card.legs.values()
        swung = np.isin(motion.log.joints, [leg.swing for leg in legs])
        return count_changes(walk, planned), float(np.abs(speed[swung]).max(initial=0))
    peak = walk.setup.limits.swing_peak
    speeds = (peak(p.direction, p.amount) for p in walk.phases if p.kind == "swing")
    switches = sum(phase.kind in ("lift", "land") for phase in walk.phases)
    return switches, max(speeds, default=0.0)


def count_changes(walk: Walk, contact: Array | None = None) -> int:
    """Lift-offs and touchdowns of whole groups in contacts, (T, F), given or measured.

    A group has lifted off when its last foot has left the ground, and touched down when
    its last foot has touched it.
    """
    recording = walk.recording
    if contact is None:
        contact = recording.contacts.between(walk.starts, recording.steps)
    changes = 0
    for group in range(len(walk.setup.robot.groups)):
        feet = contact[:, walk.setup.robot.group_of_leg == group]
        standing = np.where(feet.all(axis=1), 1, np.where(feet.any(axis=1), -1, 0))
        changes += int(np.count_nonzero(np.diff(standing[standing >= 0])))
    return changes


def carried_out(walk: Walk) -> tuple[WalkedPhase, ...]:
    """The phases of a walk, each with its slip and whether contacts were as planned."""
    dt, groups = walk.setup.limits.timestep, walk.setup.robot.groups

    def walked(p: Phase) -> WalkedPhase:
        begin, end, slip = p.start * dt, p.stop * dt, float(phase_slip(walk, p).sum())
        flow = p.segment, begin, end, p.kind, p.stratum, p.field, p.amount
        group = "".join(groups[i] for i in p.moving)
        return WalkedPhase(*flow, group, slip, as_planned(walk, p))

    return tuple(map(walked, walk.phases))
