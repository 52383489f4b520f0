"""The source of an export: a run folder, or a scenario that is walked for it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import mujoco
import numpy as np

from models import Robot, load
from models.description import actuator_of
from planner import Array
from sim.export.servo_commands import ServoCommands, taken
from sim.progress import Progress, silent
from sim.runs.arrays import reading
from sim.runs.in_memory import run_of
from sim.runs.run import Run, read_run
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
