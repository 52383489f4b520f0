"""The legs of a model: which joints swing, which lift, and which are held."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from models.checks import STEEP
from models.contact.soles import find_sole
from models.description.compiled import joints_above
from models.errors import ModelError
from planner import Array

LEVEL = np.deg2rad(60)  # axes nearer to the vertical do not lift
SOLID = range(int(mujoco.mjtGeom.mjGEOM_SPHERE), int(mujoco.mjtGeom.mjGEOM_MESH) + 1)


@dataclass(frozen=True)
class Limb:
    """A leg as it is found in the model."""

    swing: str  # joint whose axis is nearest to the vertical
    lift: str  # joint that raises the foot most
    hold: tuple[str, ...]  # further joints, from the body outward
    foot: str  # geom at its end
    hip: Array  # where the swing axis is, as the model stands, shape (2,) [m]
    toe: Array  # where the foot would touch the ground, shape (3,) [m]
    turn: float  # 1 where the swing axis points up, -1 where it points down
    up: float  # sign of the lift joint that raises the foot

    @property
    def joints(self) -> tuple[str, ...]:
        """All its joints."""
        return (self.swing, self.lift, *self.hold)


@dataclass(frozen=True)
class Pose:
    """A model with its joints somewhere, its root level."""

    model: mujoco.MjModel
    data: mujoco.MjData
    root: int

    @classmethod
    def at(cls, model: mujoco.MjModel, root: int, qpos: Array) -> Pose:
        """Put the joints where `qpos` says, and the root level at the origin."""
        data = mujoco.MjData(model)
        data.qpos[:] = qpos
        address = int(model.jnt_qposadr[model.body(root).jntadr[0]])
        data.qpos[address : address + 2] = 0.0
        data.qpos[address + 3 : address + 7] = (1.0, 0.0, 0.0, 0.0)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        return cls(model, data, root)

    def turned(self, angles: Mapping[str, float]) -> Pose:
        """The same with some joints at other angles [rad]."""
        for joint, angle in angles.items():
            self.data.joint(joint).qpos[0] = angle
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        return self

    @property
    def qpos(self) -> Array:
        """Configuration, shape (nq,)."""
        return np.array(self.data.qpos)

    @property
    def center_of_mass(self) -> Array:
        """Centre of mass, shape (3,)."""
        return np.array(self.data.subtree_com[self.root])

    def bottom(self, geom: int) -> Array:
        """Lowest point of a geom, shape (3,)."""
        name = self.model.geom(geom).name
        return find_sole(self.model, self.data, [name]).touch(self.data)

    def solid(self) -> Iterator[int]:
        """Geoms that can touch something, and all those of the body."""
        model = self.model
        for geom in range(model.ngeom):
            body = int(model.geom_bodyid[geom])
            own = model.body_rootid[body] == self.root
            touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
            touches = touches or body == self.root
            if own and touches and int(model.geom_type[geom]) in SOLID:
                yield geom


def find_limbs(pose: Pose, source: str) -> tuple[Limb, ...]:
    """The legs of a model as it stands."""
    ends: dict[int, list[int]] = {}
    for geom in pose.solid():
        joints = joints_above(pose.model, int(pose.model.geom_bodyid[geom]))
        if len(joints) > 1:
            ends.setdefault(joints[-1], []).append(geom)
    limbs = [_limb(pose, geoms, source) for geoms in ends.values()]
    if not limbs:
        raise ModelError(
            f"no legs were found: {source}; no geom that can touch the floor is "
            "connected to the body by two joints or more"
        )
    return tuple(limbs)


def _limb(pose: Pose, geoms: list[int], source: str) -> Limb:
    model, data = pose.model, pose.data
    foot = _foot(pose, geoms)
    joints = joints_above(model, int(model.geom_bodyid[foot]))
    names = [model.joint(joint).name for joint in joints]
    for joint, name in zip(joints, names, strict=True):
        if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE or not name:
            raise ModelError(
                f"the leg of {model.geom(foot).name!r} has joint {name!r}: {source}; "
                "legs turn about hinges with names"
            )
    axes, anchors = data.xaxis[joints], data.xanchor[joints]
    swing = int(np.abs(axes[:, 2]).argmax())
    lean = float(np.arccos(min(abs(axes[swing, 2]), 1.0)))
    if lean > STEEP:
        raise ModelError(
            f"the leg of {model.geom(foot).name!r} cannot swing: {source}; its joint "
            f"nearest to the vertical, {names[swing]!r}, is {np.rad2deg(lean):.0f} "
            "degrees off it, but legs must swing about the vertical"
        )
    toe = pose.bottom(foot)
    rises = np.cross(axes, toe - anchors)[:, 2]
    level = np.arccos(np.minimum(np.abs(axes[:, 2]), 1.0)) > LEVEL
    rises = np.where(level, rises, 0.0)
    lift = int(np.abs(rises).argmax())
    if not rises[lift]:
        raise ModelError(
            f"no joint lifts {model.geom(foot).name!r}: {source}; no joint of "
            "its leg has a horizontal axis"
        )
    rest = [n for k, n in enumerate(names) if k not in (swing, lift)]
    return Limb(
        swing=names[swing],
        lift=names[lift],
        hold=tuple(reversed(rest)),
        foot=model.geom(foot).name,
        hip=np.array(anchors[swing][:2]),
        toe=toe,
        turn=float(np.sign(axes[swing, 2])),
        up=float(np.sign(rises[lift])),
    )


def _foot(pose: Pose, geoms: list[int]) -> int:
    """The geom farthest out, of those that most joints move."""
    model, data = pose.model, pose.data
    depth = {g: len(joints_above(model, int(model.geom_bodyid[g]))) for g in geoms}
    last = [g for g in geoms if depth[g] == max(depth.values())]
    top = joints_above(model, int(model.geom_bodyid[last[0]]))[-1]
    hip = data.xanchor[top]

    def reach(geom: int) -> float:
        return float(np.linalg.norm(pose.bottom(geom) - hip))

    return max(last, key=reach)
