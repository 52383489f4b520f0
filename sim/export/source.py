"""The source of an export: a run folder, or a scenario that is walked for it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models import Card, Robot, load
from models.description import (
    actuator_of,
    compile_model,
    inspect_model,
    read_card,
    silence_the_engine,
)
from planner import Array
from planner.support import open_file, read_file
from sim.evaluation.arrays import trajectory
from sim.export.servo_commands import ServoCommands, taken
from sim.finished_run import arrays_of, reading
from sim.progress import Progress, silent
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import Scenario
from sim.simulation import simulate
from sim.world.servo_settings import servo_settings

UNFINISHED = "give the folder of a finished run, or the name of a scenario"
REFERENCE = ("time", "quasi_static_pose", "world_start_pose")  # of trajectory.npz


@dataclass(frozen=True, eq=False)
class Source:
    """A finished walk, as far as exporting and playing it needs.

    Attributes:
        robot: The robot that walked.
        card: Its card; in a run folder it may have been given other servos.
        model: Robot and world, as simulated.
        pieces: Commands in order, one row a physics step, shape (n, nu) each.
        steps: Number of physics steps.
        kind: Make of the servos, or `ideal`.
        rate: Commands a second; 0 for one a physics step.
        summary: Contents of summary.json.
        reference: Arrays of trajectory.npz, those of `REFERENCE`.
    """

    robot: Robot
    card: Card
    model: mujoco.MjModel
    pieces: Iterable[Array]
    steps: int
    kind: str
    rate: float
    summary: Mapping[str, Any]
    reference: Mapping[str, Array]

    @property
    def actuators(self) -> Array:
        """Actuator of each joint, shape (J,)."""
        return np.array([actuator_of(self.model, joint) for joint in self.card.joints])

    @property
    def timestep(self) -> float:
        """Of the physics [s]."""
        return float(self.model.opt.timestep)

    def commands(self, rate: float) -> ServoCommands:
        """What servos are told at a rate.

        Args:
            rate: Commands a second, where the walk itself has no rate.

        Raises:
            UsageError: If the rate is higher than that of the physics.
        """
        asked = self.rate or rate
        return taken(
            self.pieces, self.card.joints, self.actuators, asked, self.timestep
        )


def from_run(folder: Path, *, allow_external: bool = False) -> Source:
    """A walk from its run folder.

    Args:
        folder: Run folder.
        allow_external: Whether its robot may open files outside its own folder.

    Raises:
        UsageError: If it is not the folder of a finished run.
        ModelError: If its robot cannot be used.
    """
    with reading(folder, "not a finished run", UNFINISHED):
        scenario = load_scenario(str(folder / "scenario.toml"))
        summary = json.loads(read_file(folder / "summary.json"))
        arrays = arrays_of(folder, "trajectory.npz", REFERENCE)
        ctrl = arrays_of(folder, "commands.npz", ("ctrl",))["ctrl"]
        card = read_card(folder / "model.toml")
        open_file(folder / "model.xml").close()
    silence_the_engine()
    inspect_model(folder / "model.xml")  # may refuse it as it refuses any robot's
    with reading(folder, "not a finished run", UNFINISHED):
        model = _model(folder / "model.xml")
    servo = servo_settings(scenario, card)
    robot = load(
        scenario.robot,
        allow_external=allow_external,
        geometry=scenario.geometry,
    )
    return Source(
        robot, card, model, (ctrl,), len(ctrl), servo.name, servo.rate, summary, arrays
    )


def from_scenario(
    scenario: Scenario, robot: Robot, progress: Progress = silent
) -> Source:
    """A walk that is simulated now; nothing is written.

    Args:
        scenario: What to walk.
        robot: The scenario's robot.
        progress: Called with each stage and the finished part of it.

    Raises:
        PlannerError: If there is no plan.
        UsageError: If the walk takes more steps or memory than there can be.
        SimulationError: If the plan is refused, or the physics diverges.
    """
    done = simulate(scenario, robot=robot, progress=progress)
    walk = done.walk
    return Source(
        robot=robot,
        card=robot.card,
        model=walk.setup.model,
        pieces=list(walk.commands()),
        steps=walk.steps,
        kind=walk.setup.servo.name,
        rate=walk.setup.servo.rate,
        summary=done.summary,
        reference={k: v for k, v in trajectory(done.evaluation) if k in REFERENCE},
    )


def _model(path: Path) -> mujoco.MjModel:
    model = compile_model(mujoco.MjSpec.from_file(str(path)), str(path))
    model.key("start")
    return model
