"""Compliance of floor and servos under each foot, read from a compiled model.

Nothing is measured by experiment. Stiffness and damping of the contacts are the
solver's own numbers for feet that just touch the floor, and the stiffness of a lift
joint is that of its servo.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from models.contact.kinematics import Kinematics
from models.description.compiled import actuator_of, free_joint, weight_of
from models.description.robot import Robot
from planner import Array

_TOUCH = 1e-6  # [m]; depth to which the feet are lowered so that contacts appear


@dataclass(frozen=True)
class Ground:
    """Springs under the feet, and the effect of sliding on them."""

    contact: Array  # compliance of floor and foot, (F,) [m/N]
    servo: Array  # stiffness of the lift joint, (F,) [N m/rad]
    friction: float
    weight: float  # of the robot [N]
    # Sliding pushes a contact apart by friction * push * speed: a property of the
    # engine's soft contacts, not of Coulomb's law.
    push: float = 0.0  # [s]


def ground_of(robot: Robot, model: mujoco.MjModel) -> Ground:
    """The ground in a model that holds the robot, a floor and servos.

    Args:
        robot: Robot whose parts are named in the model.
        model: World to read; its keyframe `start` stands on the floor.
    """
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    _sink(robot, model, data)
    feet = [_contacts(model, data, robot.card.legs[leg].foot) for leg in robot.legs]
    springs = np.array([_spring(data, found) for found in feet])  # (F, 2)
    joints = (robot.card.legs[leg].lift for leg in robot.legs)
    touching = [index for found in feet for index in found]
    return Ground(
        contact=1 / springs[:, 0],
        servo=np.array([_servo_stiffness(model, joint) for joint in joints]),
        friction=float(np.mean([data.contact[i].friction[0] for i in touching])),
        weight=weight_of(model, robot.root),
        push=float(springs[:, 1].mean()),
    )


def _sink(robot: Robot, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Lower the root until every foot touches, and compute the contacts."""
    gap = Kinematics(robot).standing.height
    data.qpos[free_joint(model, robot.root) + 2] -= gap.max() - gap.min() + _TOUCH
    mujoco.mj_forward(model, data)


def _contacts(
    model: mujoco.MjModel, data: mujoco.MjData, foot: tuple[str, ...]
) -> list[int]:
    geoms = {model.geom(name).id for name in foot}
    return [
        i for i in range(data.ncon) if geoms & {int(g) for g in data.contact[i].geom}
    ]


def _spring(data: mujoco.MjData, contacts: list[int]) -> tuple[float, float]:
    """Stiffness of a foot's contacts together, and damping over stiffness."""
    rows = [data.contact[i].efc_address for i in contacts]
    stiffness, damping, impedance, _ = np.transpose(data.efc_KBIP[rows])
    springs = stiffness * impedance / data.efc_R[rows]
    return float(springs.sum()), float((damping / (stiffness * impedance)).mean())


def _servo_stiffness(model: mujoco.MjModel, joint: str) -> float:
    """Stiffness of the position servo that drives a joint."""
    return float(model.actuator_gainprm[actuator_of(model, joint), 0])
