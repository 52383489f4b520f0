"""Where the feet of a robot are, how its swing joints move them, where its weight is.

Read from the MJCF at given leg angles with the body held level at the pose of keyframe
`start`. No contact, no forces, no time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from models.robot import Robot, root_body

Array = np.ndarray


@dataclass(frozen=True, slots=True)
class Stance:
    """Feet and weight for one or many sets of leg angles, in the body frame."""

    feet: Array  # (..., F, 2) [m]
    rates: Array  # (..., F, 2) [m/rad], by the angle of the foot's own group
    height: Array  # (..., F) [m], lowest point of the foot above that of `start`
    center_of_mass: Array  # (..., 2) [m]


@dataclass(frozen=True)
class Kinematics:
    """Forward kinematics of one robot, as a function of its groups' angles."""

    robot: Robot

    def __post_init__(self) -> None:
        self.stance(np.zeros(len(self.robot.groups)))

    @cached_property
    def _data(self) -> mujoco.MjData:
        model = self.robot.model
        data = mujoco.MjData(model)
        keys = [model.key(i).name for i in range(model.nkey)]
        if "start" in keys:
            mujoco.mj_resetDataKeyframe(model, data, keys.index("start"))
        root = root_body(model, self.robot.path)
        address = int(model.jnt_qposadr[model.body_jntadr[root]])
        data.qpos[address : address + 2] = 0.0
        data.qpos[address + 3 : address + 7] = (1.0, 0.0, 0.0, 0.0)
        for leg in self.robot.card.legs.values():
            for joint, angle in leg.hold.items():
                data.joint(joint).qpos[:] = angle
        return data

    @cached_property
    def _joints(self) -> tuple[Array, Array]:
        """Addresses in qpos of the swing and of the lift joints, shape (F,) each."""
        model, legs = self.robot.model, [self.robot.card.legs[n] for n in self.robot.legs]
        swing = [int(model.joint(leg.swing).qposadr[0]) for leg in legs]
        lift = [int(model.joint(leg.lift).qposadr[0]) for leg in legs]
        return np.array(swing), np.array(lift)

    def stance(self, swing: Array, lift: Array | None = None) -> Stance:
        """Feet and weight at given angles.

        Args:
            swing: Angle of each group, shape (..., G) [rad].
            lift: How far each group is raised, shape (..., G) [rad]; on the ground when
                left out.
        """
        swing = np.asarray(swing, dtype=float)
        lift = np.zeros_like(swing) if lift is None else np.asarray(lift, dtype=float)
        lead = swing.shape[:-1]
        rows = [
            self._one(s, r)
            for s, r in zip(
                swing.reshape(-1, swing.shape[-1]),
                np.broadcast_to(lift, swing.shape).reshape(-1, swing.shape[-1]),
                strict=True,
            )
        ]
        columns = [np.array(c) for c in zip(*rows, strict=True)]
        return Stance(*(c.reshape(*lead, *c.shape[1:]) for c in columns))

    def _one(self, swing: Array, lift: Array) -> tuple[Array, Array, Array, Array]:
        robot, model, data = self.robot, self.robot.model, self._data
        swing_joints, lift_joints = self._joints
        of = robot.group_of_leg
        data.qpos[swing_joints] = robot.swing_sign * swing[of]
        data.qpos[lift_joints] = robot.raise_sign * lift[of]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        points = np.array([self._contact_point(leg) for leg in robot.legs])  # (F, 3)
        root = root_body(model, robot.path)
        origin = data.xpos[root]
        rates = np.array(
            [sign * self._rate(leg, p) for leg, sign, p in zip(
                robot.legs, robot.swing_sign, points, strict=True)]
        )
        feet = points[:, :2] - origin[:2]
        return feet, rates, points[:, 2], data.subtree_com[root][:2] - origin[:2]

    def _contact_point(self, leg: int) -> Array:
        """Lowest point of the leg's foot; the middle of it when it has several geoms."""
        model, data = self.robot.model, self._data
        lowest = []
        for name in self.robot.card.legs[leg].foot:
            geom = model.geom(name).id
            center = data.geom_xpos[geom].copy()
            center[2] -= _depth(model, data, geom)
            lowest.append(center)
        return np.mean(lowest, axis=0)

    def _rate(self, leg: int, point: Array) -> Array:
        """Velocity of a point of the foot by its swing joint, (2,) [m/rad]."""
        data = self._data
        joint = self.robot.model.joint(self.robot.card.legs[leg].swing).id
        return np.cross(data.xaxis[joint], point - data.xanchor[joint])[:2]


def _depth(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """How far a geom reaches below its centre [m], from its box of half sizes."""
    kind, size = model.geom_type[geom], model.geom_size[geom]
    up = data.geom_xmat[geom].reshape(3, 3)[2]  # z of the geom's axes
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return float(size[0])
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return float(size[0] + size[1] * abs(up[2]))
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return float(np.linalg.norm(size * up))
    half = model.geom_aabb[geom][3:]
    return float(np.abs(half * up).sum())
