"""An export played back in the physics, with its commands held as servos hold them."""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.evaluation.deviations import departure, off
from sim.evaluation.summary import Played
from sim.export.servo_commands import ServoCommands
from sim.export.source import Source
from sim.motion.poses import pose_of, seen_from
from sim.physics.engine import Engine
from sim.physics.measure import Sensors
from sim.physics.recording import Recorder, Recording
from sim.progress import Progress, silent
from sim.runs.run import START
from sim.scenarios.predictions import QUASI_STATIC


def play(
    source: Source, commands: ServoCommands, progress: Progress = silent
) -> Played:
    """Walk what was read back, and compare it as the walk itself was compared."""
    run = source.run
    steps = np.round(run.time / source.timestep).astype(int)
    starts = round(run.summary.walk_starts / source.timestep)
    recording = _recorded(source, commands, steps, starts, progress)
    moments = recording.moments
    kept = np.isin(moments.step, steps[steps >= starts])
    address = source.robot.root_address_in(source.model)
    origin = run.arrays[START]
    poses = seen_from(origin, pose_of(moments.qpos[kept], address))
    slip = moments.slip[-1] - recording.slip_after(starts)
    summary, predicted = run.summary, run.predicted.get(QUASI_STATIC.key)
    lengths = summary.path_length, summary.distance_walked
    return Played(
        pose=poses[-1].tolist(),
        min_margin=recording.least_margin,
        slip=float(np.maximum(slip, 0.0).sum()),
        bounces=recording.bounces,
        error={
            "goal": departure(poses[-1], np.array(summary.goal)),
            QUASI_STATIC.key: None
            if predicted is None
            else off(poses, predicted[steps >= starts], *lengths),
        },
    )


def _recorded(
    source: Source,
    commands: ServoCommands,
    steps: Array,
    starts: int,
    progress: Progress,
) -> Recording:
    """The walk of the commands, recorded at the moments of the reference."""
    sensors = Sensors(source.model, source.robot)
    recorder = Recorder(Engine(source.model), sensors, source.steps)
    recorder.walk_starts = starts
    order = [commands.joints.index(joint) for joint in source.joints]
    ordered = ServoCommands(source.joints, commands.rate, commands.angles[:, order])
    rest = source.model.key("start").ctrl
    pieces = ordered.held(rest, source.actuators, source.steps, source.timestep)
    for done in recorder.play(pieces, np.union1d(steps, [starts])):
        progress("playing", done / source.steps)
    return recorder.finish()
