"""Where the feet of a robot are, how its swing joints move them, where its weight is.

Read from the MJCF with the body held level at the pose of keyframe `start`; angles are
relative to that pose. A leg turns rigidly about two hinges, so every coordinate of its
foot, of its velocities and of its share of the centre of mass is exactly a combination
of (1, cos, sin) of one angle times (1, cos, sin) of the other: nine samples a leg give
all of them. No contact, no forces, no time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from models.robot import Robot, root_body

Array = np.ndarray

_ANGLES = 2 * np.pi / 3 * np.arange(3)
_FIT = np.linalg.inv(np.stack([np.ones(3), np.cos(_ANGLES), np.sin(_ANGLES)], axis=1))


@dataclass(frozen=True, slots=True)
class Stance:
    """Feet and weight for one or many sets of leg angles, in the body frame."""

    feet: Array  # where they touch, (..., F, 2) [m]
    rates: (
        Array  # of the sole by the swing of the foot's own group, (..., F, 2) [m/rad]
    )
    gives: Array  # of the sole by the lift of its own group, (..., F, 3) [m/rad]
    height: Array  # lowest point of the foot, (..., F) [m]
    center_of_mass: Array  # (..., 2) [m]


@dataclass(frozen=True)
class Kinematics:
    """Forward kinematics of one robot, as a function of its groups' angles."""

    robot: Robot

    def stance(self, swing: Array, lift: Array | None = None) -> Stance:
        """Feet and weight at given angles.

        Args:
            swing: Angle of each group, shape (..., G) [rad].
            lift: How far each group is raised, shape (..., G) [rad]; on the ground when
                left out.
        """
        swing = np.asarray(swing, dtype=float)
        lift = np.zeros_like(swing) if lift is None else np.asarray(lift, dtype=float)
        robot = self.robot
        s = robot.swing_gain * swing[..., robot.group_of_leg]  # (..., F)
        r = robot.raise_sign * lift[..., robot.group_of_leg]
        basis = _basis(s), _basis(r)  # (..., F, 3)
        feet, swung, lifted, weight = (
            np.einsum("fabi,...fa,...fb->...fi", coefficients, *basis)
            for coefficients in self._coefficients
        )
        return Stance(
            feet=feet[..., :2],
            rates=swung[..., :2] * robot.swing_gain[:, None],
            gives=lifted * robot.raise_sign[:, None],
            height=feet[..., 2],
            center_of_mass=self._middle[:2] + weight.sum(axis=-2)[..., :2],
        )

    @cached_property
    def _middle(self) -> Array:
        """Centre of mass with all legs at angle 0, shape (3,)."""
        return self._center_of_mass()

    @cached_property
    def _coefficients(self) -> tuple[Array, ...]:
        """Of foot, its velocity by swing and by lift, and weight: (F, 3, 3, 3) each.

        Every leg is sampled on a 3 x 3 grid of its two angles.
        """
        robot, data = self.robot, self._data
        middle, samples = self._middle, np.empty((4, len(robot.legs), 3, 3, 3))
        for i, leg in enumerate(robot.legs):
            card = robot.card.legs[leg]
            swing, lift = data.joint(card.swing), data.joint(card.lift)
            start = float(swing.qpos[0]), float(lift.qpos[0])
            for a, b in np.ndindex(3, 3):
                swing.qpos[0], lift.qpos[0] = (
                    start[0] + _ANGLES[a],
                    start[1] + _ANGLES[b],
                )
                shift = self._center_of_mass() - middle
                samples[:, i, a, b] = (*self._sole(leg), shift)
            swing.qpos[0], lift.qpos[0] = start
        fit = "pa,qb,kfabi->kfpqi"
        return tuple(np.einsum(fit, _FIT, _FIT, samples))

    @cached_property
    def _data(self) -> mujoco.MjData:
        """The robot at `start`, its root at x = y = yaw = 0."""
        data = mujoco.MjData(self.robot.model)
        data.qpos[:] = self.level_qpos
        return data

    @property
    def level_qpos(self) -> Array:
        """The robot at `start`, its root level and at x = y = yaw = 0, shape (nq,)."""
        qpos, address = self.robot.start_qpos.copy(), self.robot.root_address
        qpos[address : address + 2] = 0.0
        qpos[address + 3 : address + 7] = (1.0, 0.0, 0.0, 0.0)
        return qpos

    @cached_property
    def _root(self) -> int:
        return root_body(self.robot.model, self.robot.path)

    def _center_of_mass(self) -> Array:
        """Bring positions up to date and return the centre of mass, shape (3,)."""
        mujoco.mj_kinematics(self.robot.model, self._data)
        mujoco.mj_comPos(self.robot.model, self._data)
        origin = np.append(self._data.xpos[self._root][:2], 0.0)
        return np.array(self._data.subtree_com[self._root] - origin)

    def _sole(self, leg: int) -> tuple[Array, Array, Array]:
        """Where a foot touches, and its velocity there by swing and by lift, (3,) each.

        The middle of the foot's geoms, lowered to the ground at angle 0.
        """
        model, data, card = self.robot.model, self._data, self.robot.card.legs[leg]
        geoms = [model.geom(name).id for name in card.foot]
        center = np.mean([data.geom_xpos[geom] for geom in geoms], axis=0)
        depth = np.mean([_depth(model, geom) for geom in geoms])
        point = center - (0.0, 0.0, depth)
        jacobian = np.empty((3, model.nv))
        mujoco.mj_jac(model, data, jacobian, None, point, model.geom_bodyid[geoms[0]])
        swing, lift = (
            jacobian[:, model.joint(joint).dofadr[0]]
            for joint in (card.swing, card.lift)
        )
        return point - (*data.xpos[self._root][:2], 0.0), swing, lift


def _basis(angle: Array) -> Array:
    return np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=-1)


def _depth(model: mujoco.MjModel, geom: int) -> float:
    """How far below its centre a foot geom touches [m]; exact for spheres."""
    round_ones = (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE)
    size = model.geom_size[geom]
    return float(
        size[0] if model.geom_type[geom] in round_ones else min(size[size > 0])
    )
