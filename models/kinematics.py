"""Where the feet of a robot are, how its swing joints move them, where its weight is.

Read from the MJCF with the body held level at the pose of keyframe `start`. A leg turns
rigidly about two hinges, so every coordinate of its foot and of its share of the centre
of mass is exactly a combination of (1, cos, sin) of one angle times (1, cos, sin) of the
other: nine samples a leg give all of them. No contact, no forces, no time.
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

    feet: Array  # (..., F, 2) [m]
    rates: Array  # (..., F, 2) [m/rad], by the angle of the foot's own group
    height: Array  # (..., F) [m], lowest point of the foot
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
        s = robot.swing_sign * swing[..., robot.group_of_leg]  # (..., F)
        r = robot.raise_sign * lift[..., robot.group_of_leg]
        turned, raised = _basis(s), _basis(r)  # (..., F, 3)
        feet = np.einsum("fabi,...fa,...fb->...fi", self._feet, turned, raised)
        moved = np.einsum("fabi,...fa,...fb->...fi", self._feet, _slope(s), raised)
        weight = np.einsum("fabi,...fa,...fb->...i", self._weights, turned, raised)
        return Stance(
            feet=feet[..., :2],
            rates=moved[..., :2] * robot.swing_sign[:, None],
            height=feet[..., 2],
            center_of_mass=self._middle[:2] + weight[..., :2],
        )

    @cached_property
    def _feet(self) -> Array:
        """Coefficients of each foot's lowest point, shape (F, 3, 3, 3)."""
        return self._samples[0]

    @cached_property
    def _weights(self) -> Array:
        """Coefficients of each leg's part in the shift of the centre of mass."""
        return self._samples[1]

    @cached_property
    def _middle(self) -> Array:
        """Centre of mass with all legs at angle 0, shape (3,)."""
        return self._center_of_mass()

    @cached_property
    def _samples(self) -> tuple[Array, Array]:
        """Sample every leg on a 3 x 3 grid of angles and fit the coefficients."""
        robot, data = self.robot, self._data
        feet = np.empty((len(robot.legs), 3, 3, 3))
        weights = np.empty_like(feet)
        for i, leg in enumerate(robot.legs):
            card = robot.card.legs[leg]
            swing, lift = data.joint(card.swing), data.joint(card.lift)
            for a, b in np.ndindex(3, 3):
                swing.qpos[:], lift.qpos[:] = _ANGLES[a], _ANGLES[b]
                center_of_mass = self._center_of_mass()
                feet[i, a, b] = self._contact_point(leg)
                weights[i, a, b] = center_of_mass - self._middle
            swing.qpos[:] = lift.qpos[:] = 0.0
        fit = "pa,qb,fabi->fpqi"
        return np.einsum(fit, _FIT, _FIT, feet), np.einsum(fit, _FIT, _FIT, weights)

    @cached_property
    def _data(self) -> mujoco.MjData:
        """The robot at `start`, its root at x = y = yaw = 0 and every leg at angle 0."""
        model, robot = self.robot.model, self.robot
        data = mujoco.MjData(model)
        keys = [model.key(i).name for i in range(model.nkey)]
        if "start" in keys:
            mujoco.mj_resetDataKeyframe(model, data, keys.index("start"))
        address = int(model.jnt_qposadr[model.body_jntadr[self._root]])
        data.qpos[address : address + 2] = 0.0
        data.qpos[address + 3 : address + 7] = (1.0, 0.0, 0.0, 0.0)
        for leg in robot.card.legs.values():
            for joint in (leg.swing, leg.lift):
                data.joint(joint).qpos[:] = 0.0
            for joint, angle in leg.hold.items():
                data.joint(joint).qpos[:] = angle
        return data

    @cached_property
    def _root(self) -> int:
        return root_body(self.robot.model, self.robot.path)

    def _center_of_mass(self) -> Array:
        """Bring positions up to date and return the centre of mass, shape (3,)."""
        mujoco.mj_kinematics(self.robot.model, self._data)
        mujoco.mj_comPos(self.robot.model, self._data)
        origin = np.append(self._data.xpos[self._root][:2], 0.0)
        return np.array(self._data.subtree_com[self._root] - origin)

    def _contact_point(self, leg: int) -> Array:
        """Middle of the foot's geoms, lowered to the sole at angle 0, shape (3,)."""
        model, data = self.robot.model, self._data
        geoms = [model.geom(name).id for name in self.robot.card.legs[leg].foot]
        center = np.mean([data.geom_xpos[geom] for geom in geoms], axis=0)
        depth = np.mean([_depth(model, geom) for geom in geoms])
        return np.array(center - (*data.xpos[self._root][:2], depth))


def _basis(angle: Array) -> Array:
    return np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=-1)


def _slope(angle: Array) -> Array:
    return np.stack([np.zeros_like(angle), -np.sin(angle), np.cos(angle)], axis=-1)


def _depth(model: mujoco.MjModel, geom: int) -> float:
    """How far below its centre a foot geom touches the ground [m]; exact for spheres."""
    round_ones = (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE)
    size = model.geom_size[geom]
    return float(size[0] if model.geom_type[geom] in round_ones else min(size[size > 0]))
