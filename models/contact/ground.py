"""Compliance of floor and servos under each foot, read from a compiled model.

Stiffness and damping of the contacts are the solver's own numbers for feet that just
touch the floor, and the stiffness of a lift joint is that of its servo.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

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
    friction: float  # where feet differ, that of the roughest
    weight: float  # of the robot [N]
    # Sliding pushes a contact apart by friction * push * speed: a property of the
    # engine's soft contacts, not of Coulomb's law.
    push: float = 0.0  # [s]
    frictions: tuple[float, ...] = ()  # of every foot, where they are read

    @property
    def shares(self) -> Array:
        """Friction of every foot over that of the roughest, (F,)."""
        rubbing = np.array(self.frictions or (1.0,) * len(self.contact))
        return rubbing / max(float(rubbing.max()), 1e-300)

    def under(self, feet: Array) -> Ground:
        """The ground under some of the feet, (F,), bool."""
        own = tuple(np.array(self.frictions)[feet]) if self.frictions else ()
        return replace(
            self,
            contact=self.contact[feet],
            servo=self.servo[feet],
            friction=max(own, default=self.friction),
            frictions=own,
        )

    @classmethod
    def of(cls, robot: Robot, model: mujoco.MjModel) -> Ground:
        """The ground in a world with robot, floor and servos, at keyframe `start`."""
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        gap = Kinematics(robot).standing.height
        data.qpos[robot.root_address_in(model) + 2] -= gap.max() - gap.min() + _TOUCH
        mujoco.mj_forward(model, data)
        springs, frictions = [], []
        for leg in robot.leg_cards:
            geoms = {model.geom(name).id for name in leg.foot}
            own = [contact for contact in data.contact if geoms & {*contact.geom}]
            rows = [contact.efc_address for contact in own]
            stiffness, damping, impedance, _ = np.transpose(data.efc_KBIP[rows])
            spring = float((stiffness * impedance / data.efc_R[rows]).sum())
            springs.append((spring, float((damping / (stiffness * impedance)).mean())))
            frictions.append(float(np.mean([contact.friction[0] for contact in own])))
        lifts = [actuator_of(model, joint) for joint in robot.lift_joints]
        stiffnesses, pushes = np.transpose(springs)
        return cls(
            contact=1 / stiffnesses,
            servo=model.actuator_gainprm[lifts, 0],
            friction=max(frictions),
            weight=robot.weight_in(model),
            push=float(pushes.mean()),
            frictions=tuple(frictions),
        )
