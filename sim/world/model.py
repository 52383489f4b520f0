"""The model that a run simulates: a robot on the floor, with the run's settings.

What walking and measurement need is added to the robot's file where it is missing. The
run simulates the model that is compiled from the text.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco

from models import Robot
from models.description import compile_model
from sim.scenarios.scenario import Scenario
from sim.world.assets import gather
from sim.world.bumps import add_bumps
from sim.world.floor import ensure_floor, scene
from sim.world.imperfections import add_imperfections
from sim.world.integrator import suitable_integrator
from sim.world.sensors import ensure_sensors
from sim.world.servo_settings import servo_settings
from sim.world.servos import common_servo, ensure_servos
from sim.world.start import ensure_start
from sim.world.walls import add_walls

MODEL = "model.xml"


@dataclass(frozen=True)
class World:
    """MJCF of robot and world, with the files that it names."""

    text: str
    assets: Mapping[str, bytes]  # by path relative to the text's file
    servo: tuple[float, float] | None  # stiffness and damping, if all joints' are alike
    let_down: float  # how far its robot had to be lowered onto the floor [m]
    floor: str  # geom that its robot stands on

    @property
    def files(self) -> dict[str, bytes]:
        """What to write into a folder, so that bare MuJoCo loads it from there."""
        return {MODEL: self.text.encode(), **self.assets}


def build(robot: Robot, scenario: Scenario) -> World:
    """Robot and world, self-contained.

    Args:
        robot: Robot to put on the floor.
        scenario: Settings of solver, friction and servos.

    Raises:
        ModelError: If the robot cannot be given floor or servos.
    """
    spec = robot.read()
    _set_options(spec, scenario.timestep)
    floor = ensure_floor(spec, robot)
    _set_friction(spec, robot, floor.name, scenario.friction)
    _set_margin(spec, robot, floor.name)
    ensure_servos(spec, robot, servo_settings(scenario, robot.card))
    add_imperfections(spec, robot, floor.name, scenario)
    ensure_sensors(spec, robot, floor.name, uneven=scenario.bumps > 0)
    let_down = ensure_start(spec, robot, floor)
    if scenario.bumps:
        add_bumps(spec, floor, scenario)
    add_walls(spec, robot.root, scenario.obstacles)
    assets = gather(spec, robot)
    model = compile_model(spec, str(robot.path))
    spec.option.integrator = suitable_integrator(model)
    servo = common_servo(model, robot)
    return World(str(spec.to_xml()), assets, servo, let_down, floor.name)


def load(world: World) -> mujoco.MjModel:
    """Compile what `build` made."""
    spec = mujoco.MjSpec.from_string(world.text, assets=dict(world.assets))
    return compile_model(spec, MODEL)


def _set_options(spec: mujoco.MjSpec, timestep: float) -> None:
    """The solver settings of `scene.xml` for every robot, with the run's timestep."""
    own = scene().option
    for name in ("integrator", "cone", "impratio", "jacobian"):
        setattr(spec.option, name, getattr(own, name))
    spec.option.timestep = timestep


def _set_friction(spec: mujoco.MjSpec, robot: Robot, floor: str, value: float) -> None:
    """Sliding friction of floor and feet; the engine takes the floor's."""
    for name in (floor, *robot.card.feet):
        geom = spec.geom(name)
        geom.friction = (value, *geom.friction[1:])


def _set_margin(spec: mujoco.MjSpec, robot: Robot, floor: str) -> None:
    """No margin: the floor's stiff contact would throw a foot that is yet above it."""
    for name in (floor, *robot.card.feet):
        geom = spec.geom(name)
        geom.margin = geom.gap = 0.0
