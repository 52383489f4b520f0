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
from models.description.compiled import actuator_of
from models.description.robot import Robot
from planner import Array

_TOUCH = 1e-6  # [m]; depth to which the feet are lowered so that contacts appear


@dataclass(frozen=True)
class Ground:
    """Springs under the feet, and the effect of sliding on them.

    Example:
        >>> import numpy as np
        >>> from models import Ground
        >>> Ground(np.full(6, 1e-6), np.full(6, 1e3), friction=1.0, weight=12.5).push
        0.0
    """

    contact: Array  # compliance of floor and foot, (F,) [m/N]
    servo: Array  # stiffness of the lift joint, (F,) [N m/rad]
    friction: float
    weight: float  # of the robot [N]
    # Sliding pushes a contact apart by friction * push * speed: a property of the
    # engine's soft contacts, not of Coulomb's law.
    push: float = 0.0  # [s]

    @classmethod
    def of(cls, robot: Robot, model: mujoco.MjModel) -> Ground:
        """The ground in a world that holds the robot, a floor and servos.

        Args:
            robot: Robot whose parts are named in the model.
            model: World to read; its keyframe `start` stands on the floor.
        """
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        _sink(robot, model, data)
        feet = [_contacts(model, data, leg.foot) for leg in robot.leg_cards]
        springs = np.array([_spring(data, found) for found in feet])  # (F, 2)
        lifts = [actuator_of(model, joint) for joint in robot.lift_joints]
        touching = [index for found in feet for index in found]
        return cls(
            contact=1 / springs[:, 0],
            servo=model.actuator_gainprm[lifts, 0],
            friction=float(np.mean([data.contact[i].friction[0] for i in touching])),
            weight=robot.weight_in(model),
            push=float(springs[:, 1].mean()),
        )


def _sink(robot: Robot, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Lower the root until every foot touches, and compute the contacts."""
    gap = Kinematics(robot).standing.height
    data.qpos[robot.root_address_in(model) + 2] -= gap.max() - gap.min() + _TOUCH
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
