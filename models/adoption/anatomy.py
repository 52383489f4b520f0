"""The legs of a model: which joints swing, which lift, and which are held."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from models.checks import STEEP
from models.contact.soles import find_sole
from models.description.compiled import joints_above, levelled
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
        pose = cls(model, mujoco.MjData(model), root)
        pose.data.qpos[:] = levelled(model, root, qpos)
        pose.turn({})
        return pose

    def turn(self, angles: Mapping[str, float]) -> None:
        """Move some joints to other angles [rad]."""
        for joint, angle in angles.items():
            self.data.joint(joint).qpos[0] = angle
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def angle(self, joint: str) -> float:
        """Where a joint is [rad]."""
        return float(self.data.joint(joint).qpos[0])

    def span(self, joint: str) -> tuple[float, float]:
        """Range of a hinge [rad]; half a turn either way where it has none."""
        index = self.model.joint(joint).id
        if not self.model.jnt_limited[index]:
            return -np.pi / 2, np.pi / 2
        low, high = self.model.jnt_range[index]
        return float(low), float(high)

    @property
    def center_of_mass(self) -> Array:
        """Centre of mass, shape (3,)."""
        return np.array(self.data.subtree_com[self.root])

    def bottom(self, geom: int) -> Array:
        """Lowest point of a geom, shape (3,)."""
        name = self.model.geom(geom).name
        return find_sole(self.model, self.data, [name]).touch(self.data)

    def solid(self) -> list[int]:
        """Geoms that can touch something, and all those of the body."""
        model = self.model
        touches = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
        touches |= model.geom_bodyid == self.root
        own = model.body_rootid[model.geom_bodyid] == self.root
        solid = own & touches & np.isin(model.geom_type, SOLID)
        return [int(geom) for geom in np.flatnonzero(solid)]


def find_limbs(pose: Pose, source: str) -> tuple[Limb, ...]:
    """The legs of a model as it stands."""
    chains: dict[int, dict[int, list[int]]] = {}  # hip -> geom -> joints above it
    for geom in pose.solid():
        joints = joints_above(pose.model, int(pose.model.geom_bodyid[geom]))
        if len(joints) > 1:
            chains.setdefault(joints[-1], {})[geom] = joints
    if not chains:
        raise ModelError(
            f"no legs were found: {source}; no geom that can touch the floor is "
            "connected to the body by two joints or more"
        )
    return tuple(_limb(pose, hip, chain, source) for hip, chain in chains.items())


def _limb(pose: Pose, hip: int, chain: dict[int, list[int]], source: str) -> Limb:
    """A leg whose foot is the geom farthest out, of those that most joints move."""
    model, data = pose.model, pose.data
    anchor, most = np.array(data.xanchor[hip]), max(map(len, chain.values()))
    last = [geom for geom, joints in chain.items() if len(joints) == most]
    foot = max(last, key=lambda g: float(np.linalg.norm(pose.bottom(g) - anchor)))
    joints = chain[foot]
    name = model.geom(foot).name
    names = [model.joint(joint).name for joint in joints]
    for joint, own in zip(joints, names, strict=True):
        if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE or not own:
            raise ModelError(
                f"the leg of {name!r} has joint {own!r}: {source}; legs turn about "
                "hinges with names"
            )
    axes, anchors = data.xaxis[joints], data.xanchor[joints]
    swing = int(np.abs(axes[:, 2]).argmax())
    lean = float(np.arccos(min(abs(axes[swing, 2]), 1.0)))
    if lean > STEEP:
        raise ModelError(
            f"the leg of {name!r} cannot swing: {source}; its joint nearest to the "
            f"vertical, {names[swing]!r}, is {np.rad2deg(lean):.0f} degrees off it, "
            "but legs must swing about the vertical"
        )
    toe = pose.bottom(foot)
    rises = np.cross(axes, toe - anchors)[:, 2]
    level = np.arccos(np.minimum(np.abs(axes[:, 2]), 1.0)) > LEVEL
    rises = np.where(level, rises, 0.0)
    lift = int(np.abs(rises).argmax())
    if not rises[lift]:
        raise ModelError(
            f"no joint lifts {name!r}: {source}; no joint of its leg has a horizontal "
            "axis"
        )
    rest = [n for k, n in enumerate(names) if k not in (swing, lift)]
    return Limb(
        swing=names[swing],
        lift=names[lift],
        hold=tuple(reversed(rest)),
        foot=name,
        hip=np.array(anchors[swing][:2]),
        toe=toe,
        turn=float(np.sign(axes[swing, 2])),
        up=float(np.sign(rises[lift])),
    )
