"""The legs of a model: which joints swing, lift and are held, postures, and servos."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from models.adoption.words import refusal
from models.checks import STEEP, UNEVEN_FEET
from models.contact.kinematics import Kinematics, find_sole
from models.description.actuators import position_servos_of, span_of
from models.description.card import Servo
from models.description.compiled import fixed_to, joints_above, levelled
from models.description.robot import Robot
from models.errors import ModelError
from planner import Array

FARTHEST = 1e3  # [rad] that a hinge is taken to turn, whatever its range says
LEVEL = np.deg2rad(60)  # axes nearer to the vertical do not lift
SOLID = range(int(mujoco.mjtGeom.mjGEOM_SPHERE), int(mujoco.mjtGeom.mjGEOM_MESH) + 1)


@dataclass(frozen=True, eq=False)
class Limb:
    """A leg as it is found in the model."""

    swing: str  # joint whose axis is nearest to the vertical
    lift: str  # joint that raises the foot most
    hold: tuple[str, ...]  # further joints, from the body outward
    foot: str  # geom at its end
    soles: tuple[str, ...]  # it, and others that are as low
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
    def at(cls, model: mujoco.MjModel, root: int, qpos: Array) -> "Pose":
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
        """Range of a hinge and its servos [rad]; a quarter turn where it has none."""
        low, high = np.clip(span_of(self.model, joint, np.pi / 2), -FARTHEST, FARTHEST)
        return float(low), float(high)

    @property
    def center_of_mass(self) -> Array:
        """Centre of mass, shape (3,)."""
        return np.array(self.data.subtree_com[self.root])

    def bottom(self, *geoms: int) -> Array:
        """Lowest point of geoms, shape (3,)."""
        names = [self.model.geom(geom).name for geom in geoms]
        return find_sole(self.model, self.data, names).touch(self.data)

    def solid(self) -> list[int]:
        """Geoms that can touch something, and all those of the body."""
        model = self.model
        touches = (model.geom_contype | model.geom_conaffinity) != 0
        touches[fixed_to(model, self.root)] = True
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
        raise refusal("no_legs", source)
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
            raise refusal("no_hinge", source, foot=name, joint=own)
    axes, anchors = data.xaxis[joints], data.xanchor[joints]
    swing = int(np.abs(axes[:, 2]).argmax())
    lean = float(np.arccos(min(abs(axes[swing, 2]), 1.0)))
    if lean > STEEP:
        nearest = {"foot": name, "joint": names[swing]}
        raise refusal("no_swing", source, **nearest, lean=np.rad2deg(lean))
    toe = pose.bottom(foot)
    level = np.arccos(np.minimum(np.abs(axes[:, 2]), 1.0)) > LEVEL
    rises = np.where(level, np.cross(axes, toe - anchors)[:, 2], 0.0)
    lift = int(np.abs(rises).argmax())
    if not rises[lift]:
        raise refusal("no_lift", source, foot=name)
    rest = [n for k, n in enumerate(names) if k not in (swing, lift)]
    low = [g for g in last if chain[g] == joints and g != foot]
    low = [geom for geom in low if pose.bottom(geom)[2] < toe[2] + 1e-4]  # [m]
    return Limb(
        swing=names[swing],
        lift=names[lift],
        hold=(*rest[::-1],),
        foot=name,
        soles=(name, *(model.geom(geom).name for geom in low)),
        hip=np.array(anchors[swing][:2]),
        toe=toe,
        turn=float(np.sign(axes[swing, 2])),
        up=float(np.sign(rises[lift])),
    )


GRID = 41  # angles of each joint that are tried
CLEARANCE = 0.3  # of a leg's reach, that the body is wanted above the floor


def stands(pose: Pose, limbs: Sequence[Limb]) -> bool:
    """Whether the feet are on one plane, and nothing else is as low."""
    soles = [[pose.model.geom(name).id for name in limb.soles] for limb in limbs]
    *across, height = np.array([pose.bottom(*sole) for sole in soles]).T
    others = [pose.bottom(g)[2] for g in {*pose.solid()}.difference(*soles)]
    flat = np.ptp(height) <= UNEVEN_FEET * np.ptp(across, axis=1).max()
    return bool(flat and min(others, default=np.inf) > height.max())


def standing_angles(pose: Pose, limbs: Sequence[Limb], source: str) -> dict[str, float]:
    """Angles of lift and held joints that put all feet on one floor under the body.

    The pose is moved; without such angles the robot is refused.
    """
    trunk = {*fixed_to(pose.model, pose.root)} & {*pose.solid()}
    belly = min((pose.bottom(geom)[2] for geom in trunk), default=0.0)
    tables = [_table(pose, limb) for limb in limbs]
    lows = [float(table[:, 2].min()) for table in tables]
    lowest = max(lows)
    reach = max(float(np.linalg.norm(limb.toe[:2] - limb.hip)) for limb in limbs)
    floor = max(belly - CLEARANCE * reach, 0.9 * lowest + 0.1 * belly)
    if not floor < belly:
        joints, reached = limbs[lows.index(lowest)].joints[:2], 1e3 * (belly - lowest)
        raise refusal("too_low", source, joints=" and ".join(joints), reached=reached)
    angles: dict[str, float] = {}
    for limb, table in zip(limbs, tables, strict=True):
        angles |= _lowered(pose, limb, table, floor, source)
    return angles


def _within(pose: Pose, joint: str) -> Array:
    low, high = pose.span(joint)
    keep = 0.15 * (high - low)  # from the ends of the joint's range
    return np.linspace(low + keep, high - keep, GRID)


def _table(pose: Pose, limb: Limb) -> Array:
    """Rows of lift angle, held angle, height of the foot, lean of the shank, reach."""
    before, hold = pose.data.qpos.copy(), limb.hold[-1:]
    foot = pose.model.geom(limb.foot).id
    rows = []
    holds = _within(pose, hold[0]) if hold else (0.0,)
    for lift, held in product(_within(pose, limb.lift), holds):
        pose.turn({limb.lift: lift} | dict.fromkeys(hold, held))
        toe = pose.bottom(foot)
        arm = toe - pose.data.joint(hold[0] if hold else limb.lift).xanchor
        lean = float(np.linalg.norm(arm[:2]) / np.linalg.norm(arm))
        rows.append((lift, held, toe[2], lean, np.linalg.norm(toe[:2] - limb.hip)))
    pose.data.qpos[:] = before
    pose.turn({})
    return np.array(rows)


def _lowered(
    pose: Pose, limb: Limb, table: Array, floor: float, source: str
) -> Mapping[str, float]:
    """Angles that put one foot on the floor, the shank as upright as it may be."""
    reach = table[:, 4].max()
    off = np.abs(table[:, 2] - floor) / reach
    lean = np.where(table[:, 4] > 0.3 * reach, table[:, 3], 2.0)
    best = table[np.argmin(10 * off + lean)]
    held = dict.fromkeys(limb.hold[-1:], float(best[1]))
    step = float(np.ptp(_within(pose, limb.lift))) / GRID
    low, high = best[0] - 3 * step, best[0] + 3 * step

    def above(lift: float) -> float:
        pose.turn(held | {limb.lift: lift})
        return float(pose.bottom(pose.model.geom(limb.foot).id)[2]) - floor

    first, last = above(low), above(high)
    if first * last > 0:
        raise refusal("too_uneven", source, foot=limb.foot)
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if above(middle) * first > 0 else (low, middle)
    return held | {limb.lift: float((low + high) / 2)}


STIFF = 2500.0  # times the torque that a leg bears, for a radian
FASTEST = 700.0  # [rad/s] of a servo's own frequency, as that of the shipped robots


def servo_for(robot: Robot) -> Servo:
    """A servo that suits all leg joints of a robot."""
    pose = Pose.at(robot.model, robot.model.body(robot.root).id, robot.start_qpos)
    hips = np.array([pose.data.joint(name).xanchor[:2] for name in robot.swing_joints])
    arm = float(np.linalg.norm(Kinematics(robot).standing.feet - hips, axis=1).max())
    return drafted_servo(pose, robot.card.joints, arm, len(robot.legs))


def drafted_servo(pose: Pose, joints: Sequence[str], arm: float, legs: int) -> Servo:
    """A servo for some joints of a robot that stands, critically damped.

    Half of the legs bear the weight with little sag, on arms from hip to foot [m]. As
    the physics cannot follow a mere leg's inertia, joints without rotors get some.
    """
    model = pose.model
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_crb(model, pose.data)
    mujoco.mj_fullM(model, pose.data, inertia)
    own = np.diag(inertia)[[int(model.joint(name).dofadr[0]) for name in joints]]
    weight = 9.81 * float(model.body_subtreemass[pose.root])
    with np.errstate(over="ignore"):  # what comes out is looked at
        stiffness = float(STIFF * weight * arm / (legs / 2))
        armature = max(stiffness / FASTEST**2 - float(own.min()), 0.0)
        critical = 2 * float(np.sqrt(stiffness * (np.median(own) + armature)))
    if not np.isfinite(critical):
        raise ModelError(f"too heavy: {weight:g} N; correct masses and densities")
    return Servo(stiffness, critical, armature=armature)


def servo_stiffness(model: mujoco.MjModel, joint: str) -> float:
    """Stiffness of the position servo that drives a joint, 0 if none does [N m/rad]."""
    for i in position_servos_of(model, joint):
        return float(model.actuator_gainprm[i, 0] * model.actuator_gear[i, 0] ** 2)
    return 0.0
