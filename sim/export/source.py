"""The source of an export, a run folder or a scenario walked for it, and its playback.

Servos hold each command until the next one. A controller of ROS 2 that follows a
trajectory of positions moves evenly from one to the next, and holds the last.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import mujoco
import numpy as np

from models import Kinematics, Robot, load
from models.description import actuator_of
from planner import Array
from sim.evaluation.deviations import Scale, departure, off
from sim.evaluation.summary import Played
from sim.export.servo_commands import ServoCommands, taken
from sim.motion.poses import pose_of, seen_from
from sim.physics.engine import Engine
from sim.physics.measure import Sensors
from sim.physics.recording import Recorder, Recording
from sim.progress import Progress, silent
from sim.runs.arrays import reading
from sim.runs.in_memory import run_of
from sim.runs.run import START, Run, read_run
from sim.scenarios.scenario import Scenario
from sim.simulation import simulate
from sim.world.servo_settings import ServoSettings, servo_settings


@dataclass(frozen=True, eq=False)
class Source:
    """A run with its robot and its model, which exporting and playing it needs."""

    run: Run
    robot: Robot
    model: mujoco.MjModel  # robot and world, as simulated

    @cached_property
    def servo(self) -> ServoSettings:
        """Make and command rate of the servos."""
        return servo_settings(self.run.scenario, self.run.card)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the legs."""
        return self.run.card.joints

    @property
    def actuators(self) -> Array:
        """Actuator of each joint, shape (J,)."""
        return np.array([actuator_of(self.model, joint) for joint in self.joints])

    @property
    def steps(self) -> int:
        """Number of physics steps."""
        return len(self.run.commands["time"])

    @property
    def timestep(self) -> float:
        """Of the physics [s]."""
        return float(self.model.opt.timestep)

    def commands(self, rate: float) -> ServoCommands:
        """Commands of the servos at a rate, where the walk itself has none."""
        ctrl, asked = self.run.commands["ctrl"], self.servo.rate or rate
        return taken(ctrl, self.joints, self.actuators, asked, self.timestep)


def from_run(folder: Path, *, allow_external: bool = False) -> Source:
    """A walk from its run folder, whose robot may open files elsewhere if allowed."""
    run = read_run(folder)
    model = run.model
    with reading(folder):
        model.key("start")
    name, geometry = run.scenario.robot, run.scenario.geometry
    robot = load(name, allow_external=allow_external, geometry=geometry)
    return Source(run, robot, model)


def from_scenario(
    scenario: Scenario, robot: Robot, progress: Progress = silent
) -> Source:
    """A walk that is simulated now; nothing is written."""
    done = simulate(scenario, robot=robot, progress=progress)
    return Source(run_of(done.evaluation, done.summary), robot, done.walk.setup.model)


def play(
    source: Source,
    commands: ServoCommands,
    progress: Progress = silent,
    *,
    interpolated: bool = False,
) -> Played:
    """Walk what was read back, and compare it as the walk itself was compared."""
    run = source.run
    steps = np.round(run.time / source.timestep).astype(int)
    starts = round(run.summary.walk_starts / source.timestep)
    recording = _recorded(source, commands, interpolated, steps, starts, progress)
    moments, walking = recording.moments, steps >= starts
    kept = np.isin(moments.step, steps[walking])
    address = source.robot.root_address_in(source.model)
    origin = run.arrays[START]
    poses = seen_from(origin, pose_of(moments.qpos[kept], address))
    slip = moments.slip[-1] - recording.slip_after(starts)
    summary, goal = run.summary, run.summary.goal
    lengths = summary.path_length, summary.distance_walked
    predicted = {key: found[walking] for key, found in run.predicted.items()}
    reach = Kinematics(source.robot).reach
    scale = Scale.of(run.scenario.path, reach, predicted)
    return Played(
        pose=poses[-1].tolist(),
        min_margin=recording.least_margin,
        slip=float(np.maximum(slip, 0.0).sum()),
        bounces=recording.bounces,
        error={
            **({} if goal is None else {"goal": departure(poses[-1], np.array(goal))}),
            **{key: off(poses, found, *lengths) for key, found in predicted.items()},
        },
        weighed=scale.weigh(poses, predicted[scale.prediction], goal),
        changed=scale.share(poses[-1], run.achieved[-1]),
    )


def _recorded(
    source: Source,
    commands: ServoCommands,
    interpolated: bool,
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
    length = source.steps, source.timestep
    pieces = ordered.rows(rest, source.actuators, *length, interpolated=interpolated)
    for done in recorder.play(pieces, np.union1d(steps, [starts])):
        progress("playing", done / source.steps)
    return recorder.finish()
