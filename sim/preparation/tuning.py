"""Numbers of a model that are replaced without compiling it again.

These are frictions, the gains of servos, and the payload's mass and place. The model
that results is the one that would be compiled, to the last bit.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import replace

import mujoco

from models import Robot
from models.description import actuator_of
from sim.scenarios.scenario import Scenario
from sim.world.imperfections import PAYLOAD
from sim.world.integrator import suitable_integrator
from sim.world.model import World

UNIT = (1.0, 0.0, 0.0, 0.0)  # payload: mass [kg] and place [m]


def is_tunable(scenario: Scenario, robot: Robot) -> bool:
    """Whether a scenario's model may be one with its numbers replaced.

    Args:
        scenario: Settings of the world.
        robot: Robot in it.
    """
    rough = scenario.foot_friction
    alike = rough is None or len(rough) == len(robot.legs)
    return alike and scenario.servo in (None, "ideal")


def untuned(scenario: Scenario) -> Scenario:
    """The scenario with other numbers in place of those that are replaced.

    Args:
        scenario: Settings of a world.
    """
    rough, load = scenario.foot_friction, scenario.payload
    return replace(
        scenario,
        friction=1.0,
        foot_friction=None if rough is None else (1.0,) * len(rough),
        payload=UNIT if load is not None and load[0] else None,
        servo_stiffness=None,
        servo_damping=None,
    )


def tuned(
    world: World, plain: mujoco.MjModel, robot: Robot, scenario: Scenario
) -> tuple[World, mujoco.MjModel]:
    """A world and its model with their numbers replaced, as if compiled with them.

    Args:
        world: Of the untuned scenario.
        plain: Compiled from it.
        robot: Robot in it.
        scenario: The numbers to put in place.
    """
    model = copy.copy(plain)
    model.geom(world.floor).friction[0] = _written(scenario.friction)
    for name, value in _foot_frictions(robot, scenario):
        model.geom(name).friction[0] = _written(value)
    servo = _set_gains(model, world.servo or (0.0, 0.0), robot, scenario)
    if scenario.payload is not None and scenario.payload[0]:
        _load(model, plain, *scenario.payload)
    model.opt.integrator = suitable_integrator(model)
    # Nobody writes the model of a sweep's point, so its text is left as it was.
    return replace(world, servo=servo), model


def _foot_frictions(robot: Robot, scenario: Scenario) -> Iterator[tuple[str, float]]:
    own = scenario.foot_friction or (scenario.friction,) * len(robot.legs)
    for leg, value in zip(robot.legs, own, strict=True):
        for name in robot.card.legs[leg].foot:
            yield name, value


def _set_gains(
    model: mujoco.MjModel,
    gains: tuple[float, float],
    robot: Robot,
    scenario: Scenario,
) -> tuple[float, float]:
    """Put stiffness and damping in place where they are given."""
    driving = [actuator_of(model, joint) for joint in robot.card.joints]
    stiffness, damping = gains
    if scenario.servo_stiffness is not None:
        stiffness = scenario.servo_stiffness
        model.actuator_gainprm[driving, 0] = _written(stiffness)
        model.actuator_biasprm[driving, 1] = -_written(stiffness)
    if scenario.servo_damping is not None:
        damping = scenario.servo_damping
        model.actuator_biasprm[driving, 2] = -_written(damping)
    return stiffness, damping


def _load(
    model: mujoco.MjModel, plain: mujoco.MjModel, mass: float, *place: float
) -> None:
    """Replace the payload, and the constants that follow from it."""
    body = model.body(PAYLOAD)
    body.mass[:] = _written(mass)
    body.inertia[:] = plain.body(PAYLOAD).inertia * _written(mass)
    body.pos[:] = [_written(along) for along in place]
    mujoco.mj_setConst(model, mujoco.MjData(model))


def _written(value: float) -> float:
    """A number as it is once MuJoCo has written it as text and read it again."""
    return float(f"{value:g}")
