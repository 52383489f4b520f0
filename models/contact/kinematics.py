"""Forward kinematics: feet, their velocities, lifts and the centre of mass of a robot.

The body is held level in the pose of keyframe `start`, and angles are relative to that
pose. A leg turns rigidly about two hinges, so every coordinate of its foot, of the
foot's velocities and of its share of the centre of mass is exactly a combination of
(1, cos, sin) of one angle times (1, cos, sin) of the other: nine samples determine it.

A foot stands on its sole, the lowest points of its geoms when the robot stands. A round
geom touches the floor vertically below a point that is fixed in the leg; one with edges
or corners touches with these.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import mujoco
import numpy as np

from models.description.card import LegCard
from models.description.compiled import levelled
from models.description.robot import Robot
from models.errors import ModelError, message
from planner import Array

Geom = mujoco.mjtGeom


@dataclass(frozen=True, eq=False, slots=True)
class Core:
    """Points whose convex hull, widened by a radius, is a geom."""

    points: Array  # in the geom's frame, (k, 3) [m]
    radius: float = 0.0  # [m]


def covering_core(model: mujoco.MjModel, geom: int) -> Core | None:
    """The core of a geom, if any; a cylinder's capsule, the box of an ellipsoid."""
    size = model.geom_size[geom]
    match model.geom_type[geom]:
        case Geom.mjGEOM_SPHERE:
            return Core(np.zeros((1, 3)), float(size[0]))
        case Geom.mjGEOM_CAPSULE | Geom.mjGEOM_CYLINDER:
            return Core(_ends(size), float(size[0]))
        case Geom.mjGEOM_BOX | Geom.mjGEOM_ELLIPSOID:
            return Core(np.array(list(product((-1.0, 1.0), repeat=3))) * size)
        case Geom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            return Core(model.mesh_vert[first : first + count].astype(float))
    return None


def _ends(size: Array) -> Array:
    return np.array([(0, 0, -size[1]), (0, 0, size[1])])


@dataclass(frozen=True, eq=False)
class Sole:
    """Points of a leg; the floor acts below their mean."""

    geoms: Array  # geom that each belongs to, (n,)
    points: Array  # in that geom's frame, (n, 3) [m]
    depth: float  # distance from the points down to the floor [m]

    def touch(self, data: mujoco.MjData) -> Array:
        """Contact point of the foot, provided that it touches, shape (3,)."""
        return self.placed(data).mean(axis=0) - (0.0, 0.0, self.depth)

    def placed(self, data: mujoco.MjData) -> Array:
        """Its points in the world, shape (n, 3)."""
        turns = data.geom_xmat[self.geoms].reshape(-1, 3, 3)
        return data.geom_xpos[self.geoms] + np.einsum("nij,nj->ni", turns, self.points)


def find_sole(model: mujoco.MjModel, data: mujoco.MjData, foot: Sequence[str]) -> Sole:
    """The sole of a foot with these geoms, as the robot stands."""
    numbers = [model.geom(name).id for name in foot]
    cores = [_lowest_core(model, data, geom) for geom in numbers]
    counts = [len(core.points) for core in cores]
    geoms = np.repeat(numbers, counts)
    depths = np.repeat([core.radius for core in cores], counts)
    points = np.concatenate([core.points for core in cores])
    bottom = Sole(geoms, points, 0.0).placed(data)[:, 2] - depths
    lowest = bottom <= bottom.min() + 1e-4  # [m]; those as close touch as well
    return Sole(geoms[lowest], points[lowest], float(depths[lowest].mean()))


def _lowest_core(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Core:
    """The core of a geom; the lowest points of an ellipsoid or a cylinder's rims."""
    size, kind = model.geom_size[geom], model.geom_type[geom]
    down = -data.geom_xmat[geom].reshape(3, 3)[2]  # in the geom's frame
    if kind == Geom.mjGEOM_CYLINDER:
        across = np.append(down[:2], 0.0)
        length = float(np.linalg.norm(across))
        return Core(_ends(size) + across * (size[0] / length if length > 1e-5 else 0.0))
    if kind == Geom.mjGEOM_ELLIPSOID:
        return Core((size**2 * down / np.linalg.norm(size * down))[None])
    if (core := covering_core(model, geom)) is not None:
        return core
    shape = Geom(kind).name.removeprefix("mjGEOM_").lower()
    raise ModelError(message("sole", foot=model.geom(geom).name, shape=shape))


UPRIGHT = np.deg2rad(3)  # smaller tilts change lengths by less than 0.2 %
TABLE = 1001  # angles up to the farthest; heights in between are interpolated
_ANGLES = 2 * np.pi / 3 * np.arange(3)
_FIT = np.linalg.inv(np.stack([np.ones(3), np.cos(_ANGLES), np.sin(_ANGLES)], axis=1))
Legs = Array | slice


@dataclass(frozen=True, eq=False, slots=True)
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
        turn, rise = (  # (3, F, ...) each: long rows last, as these are summed fast
            np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)])
            for angle in (a.T.copy() for a in robot.joint_angles(swing, lift))
        )
        every: tuple[Legs, ...] = (legs, legs, legs, slice(None))
        feet, swung, lifted, weight = (
            np.einsum("fabi,af...,bf...->if...", c[on], turn[:, on], rise[:, on]).T
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

    @property
    def farthest_lift(self) -> float:
        """Largest angle that all lift joints and servos reach, up to half a turn."""
        robot, ends = self.robot, [np.pi]
        for joint, sign in zip(robot.lift_joints, robot.raise_sign, strict=True):
            left = np.array(robot.span(joint)) - robot.standing_angle(joint)
            ends.append(float((sign * left).max()))
        return min(ends)

    def rise(self, lift: Array) -> Array:
        """How far feet leave the ground, all lifted by angles (...), (..., F) [m]."""
        groups = len(self.robot.groups)
        angles = np.repeat(np.append(lift, 0.0)[:, None], groups, axis=1)
        height = self.stance(np.zeros_like(angles), angles).height
        return (height[:-1] - height[-1]).reshape(*np.shape(lift), -1)

    @property
    def highest(self) -> float:
        """Height that every foot reaches [m]."""
        return float(self._rises[1].max())

    def lift_to(self, height: float) -> float:
        """Least angle at which every foot is that high [rad]; ValueError if none is."""
        angles, rises = self._rises
        if height > self.highest:
            raise ValueError(f"{height} m is above the highest, {self.highest} m")
        top = int(rises.argmax()) + 1
        return float(np.interp(height, rises[:top], angles[:top]))

    @cached_property
    def _rises(self) -> tuple[Array, Array]:
        angles = np.linspace(0, max(self.farthest_lift, 0.0), TABLE)
        return angles, self.rise(angles).min(axis=1)

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
