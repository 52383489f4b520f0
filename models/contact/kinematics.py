"""Forward kinematics: feet, their velocities, lifts and the centre of mass of a robot.

The body is held level in the pose of keyframe `start`, and angles are relative to that
pose. A leg turns rigidly about two hinges. Every coordinate of its foot, of the foot's
velocities and of its share of the centre of mass is therefore exactly a combination of
(1, cos, sin) of one angle times (1, cos, sin) of the other: nine samples determine it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from models.contact.soles import Sole, find_sole
from models.description.card import LegCard
from models.description.compiled import levelled
from models.description.robot import Robot
from planner import Array

UPRIGHT = np.deg2rad(3)  # smaller tilts change lengths by less than 0.2 %
_ANGLES = 2 * np.pi / 3 * np.arange(3)
_FIT = np.linalg.inv(np.stack([np.ones(3), np.cos(_ANGLES), np.sin(_ANGLES)], axis=1))


Legs = Array | slice


@dataclass(frozen=True, slots=True)
class Stance:
    """Feet and centre of mass for one or many sets of leg angles, in the body frame."""

    feet: Array  # contact points, (..., F, 2) [m]
    rates: Array  # derivative of the soles by the swing angles, (..., F, 2) [m/rad]
    gives: Array  # derivative of the soles by the lift angles, (..., F, 3) [m/rad]
    height: Array  # lowest point of the foot, (..., F) [m]
    center_of_mass: Array  # (..., 2) [m]


@dataclass(frozen=True)
class Kinematics:
    """Forward kinematics of one robot, as a function of its groups' angles.

    Example:
        >>> from models import Kinematics, load
        >>> Kinematics(load("hexapod")).standing.feet[0].round(3)  # x, y [m]
        array([0.15, 0.18])
    """

    robot: Robot

    def stance(
        self, swing: Array, lift: Array | None = None, legs: Legs = slice(None)
    ) -> Stance:
        """Feet of some legs and centre of mass, groups swung and raised (..., G) [rad].

        The feet are on the ground when `lift` is left out.
        """
        swing = np.asarray(swing, dtype=float)
        lift = np.zeros_like(swing) if lift is None else np.asarray(lift, dtype=float)
        robot = self.robot
        turned, raised = robot.joint_angles(swing, lift)  # (..., F)
        turn, rise = (  # (..., F, 3) each
            np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=-1)
            for angle in (turned, raised)
        )
        every: tuple[Legs, ...] = (legs, legs, legs, slice(None))
        feet, swung, lifted, weight = (
            np.einsum(
                "fabi,...fa,...fb->...fi", c[on], turn[..., on, :], rise[..., on, :]
            )
            for c, on in zip(self.terms, every, strict=True)
        )
        return Stance(
            feet=feet[..., :2],
            rates=swung[..., :2] * robot.swing_gain[legs, None],
            gives=lifted * robot.raise_sign[legs, None],
            height=feet[..., 2],
            center_of_mass=self.center_of_mass[:2] + weight.sum(axis=-2)[..., :2],
        )

    @cached_property
    def standing(self) -> Stance:
        """Feet and centre of mass with all legs at angle 0."""
        return self.stance(np.zeros(len(self.robot.groups)))

    @cached_property
    def lifting(self) -> Lifting:
        """How high the robot can raise its feet."""
        return Lifting(self)

    @property
    def reach(self) -> float:
        """Mean distance of the feet from the middle, all legs at angle 0 [m]."""
        return float(np.linalg.norm(self.standing.feet, axis=1).mean())

    @cached_property
    def center_of_mass(self) -> Array:
        """Centre of mass with all legs at angle 0, shape (3,)."""
        return self._find_center_of_mass()

    @cached_property
    def terms(self) -> tuple[Array, ...]:
        """Feet, their velocities by swing and lift, and each leg's shift of the weight.

        Coefficients of (1, cos, sin) of swing and of lift, (F, 3, 3, 3) each.
        """
        robot, data = self.robot, self._data
        middle, samples = self.center_of_mass, np.empty((4, len(robot.legs), 3, 3, 3))
        soles = [find_sole(robot.model, data, leg.foot) for leg in robot.leg_cards]
        for i, (card, sole) in enumerate(zip(robot.leg_cards, soles, strict=True)):
            swing, lift = data.joint(card.swing), data.joint(card.lift)
            start = float(swing.qpos[0]), float(lift.qpos[0])
            for a, b in np.ndindex(3, 3):
                swing.qpos[0] = start[0] + _ANGLES[a]
                lift.qpos[0] = start[1] + _ANGLES[b]
                shift = self._find_center_of_mass() - middle
                samples[:, i, a, b] = (*self._touch(card, sole), shift)
            swing.qpos[0], lift.qpos[0] = start
        return tuple(np.einsum("pa,qb,kfabi->kfpqi", _FIT, _FIT, samples))

    @cached_property
    def _data(self) -> mujoco.MjData:
        """The robot at `level_qpos`; its legs move only while they are sampled."""
        data = mujoco.MjData(self.robot.model)
        data.qpos[:] = self.level_qpos
        mujoco.mj_kinematics(self.robot.model, data)
        return data

    @property
    def level_qpos(self) -> Array:
        """The robot at `start`, its root level and at x = y = yaw = 0, shape (nq,)."""
        model = self.robot.model
        return levelled(model, model.body(self.robot.root).id, self.robot.start_qpos)

    def hinge(self, joint: str) -> tuple[Array, Array]:
        """Direction of its axis as the robot stands, and a point on it [m], (3,)."""
        mujoco.mj_kinematics(self.robot.model, self._data)
        found = self._data.joint(joint)
        return np.array(found.xaxis), np.array(found.xanchor)

    def _find_center_of_mass(self) -> Array:
        """Bring positions up to date and return the centre of mass, shape (3,)."""
        mujoco.mj_kinematics(self.robot.model, self._data)
        mujoco.mj_comPos(self.robot.model, self._data)
        root = self._data.body(self.robot.root)
        return np.array(root.subtree_com - (*root.xpos[:2], 0.0))

    def _touch(self, card: LegCard, sole: Sole) -> tuple[Array, Array, Array]:
        """Where a foot touches, and its velocity by swing and by lift, (3,) each."""
        model, data = self.robot.model, self._data
        point = sole.touch(data)
        jacobian = np.empty((3, model.nv))
        body = model.geom_bodyid[sole.geoms[0]]
        mujoco.mj_jac(model, data, jacobian, None, point, body)
        swing, lift = (model.joint(name).dofadr[0] for name in (card.swing, card.lift))
        place = point - (*data.body(self.robot.root).xpos[:2], 0.0)
        return place, jacobian[:, swing], jacobian[:, lift]


TABLE = 1001  # angles up to the farthest; heights in between are interpolated


@dataclass(frozen=True)
class Lifting:
    """Lifts of all legs at once from the standing configuration, legs at swing 0."""

    kinematics: Kinematics

    @property
    def farthest(self) -> float:
        """Largest angle that all lift joints and servos reach, up to half a turn."""
        robot, ends = self.kinematics.robot, [np.pi]
        for joint, sign in zip(robot.lift_joints, robot.raise_sign, strict=True):
            left = np.array(robot.span(joint)) - robot.standing_angle(joint)
            ends.append(float((sign * left).max()))
        return min(ends)

    def rise(self, angle: Array) -> Array:
        """How far each foot leaves the ground at angles (...), shape (..., F) [m]."""
        groups = len(self.kinematics.robot.groups)
        lift = np.repeat(np.append(angle, 0.0)[:, None], groups, axis=1)
        height = self.kinematics.stance(np.zeros_like(lift), lift).height
        return (height[:-1] - height[-1]).reshape(*np.shape(angle), -1)

    @property
    def highest(self) -> float:
        """Height that every foot reaches [m]."""
        return float(self._table[1].max())

    def angle(self, height: float) -> float:
        """Least angle at which every foot is that high [rad]; ValueError if none is."""
        angles, rises = self._table
        if height > self.highest:
            raise ValueError(f"{height} m is above the highest, {self.highest} m")
        top = int(rises.argmax()) + 1
        return float(np.interp(height, rises[:top], angles[:top]))

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        angles = np.linspace(0, max(self.farthest, 0.0), TABLE)
        return angles, self.rise(angles).min(axis=1)
