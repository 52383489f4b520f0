"""Postures for legs that are stretched out or folded, servos for joints without."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import mujoco
import numpy as np

from models.adoption.anatomy import Limb, Pose
from models.checks import UNEVEN_FEET
from models.contact.kinematics import Kinematics
from models.description.card import Servo
from models.description.compiled import actuators_of, is_position_servo
from models.description.robot import Robot
from models.errors import ModelError
from planner import Array

GRID = 41  # angles of each joint that are tried
CLEARANCE = 0.3  # of a leg's reach, that the body is wanted above the floor
MARGIN = 0.15  # of a joint's range to keep from its ends
BISECTIONS = 30  # of the bisection for the height of a foot


def stands(pose: Pose, limbs: Sequence[Limb]) -> bool:
    """Whether the feet are on one plane, and nothing else is as low."""
    feet = [pose.model.geom(limb.foot).id for limb in limbs]
    *across, height = np.array([pose.bottom(foot) for foot in feet]).T
    others = [pose.bottom(g)[2] for g in pose.solid() if g not in feet]
    flat = np.ptp(height) <= UNEVEN_FEET * np.ptp(across, axis=1).max()
    return bool(flat and min(others, default=np.inf) > height.max())


def standing_angles(pose: Pose, limbs: Sequence[Limb], source: str) -> dict[str, float]:
    """Angles of lift and held joints that put all feet on one floor under the body.

    The pose is moved; without such angles the robot is refused.
    """
    bodies = pose.model.geom_bodyid
    own = [geom for geom in pose.solid() if bodies[geom] == pose.root]
    belly = min((pose.bottom(geom)[2] for geom in own), default=0.0)
    tables = [_table(pose, limb) for limb in limbs]
    lowest = max(float(table[:, 2].min()) for table in tables)
    reach = max(float(np.linalg.norm(limb.toe[:2] - limb.hip)) for limb in limbs)
    floor = max(belly - CLEARANCE * reach, 0.9 * lowest + 0.1 * belly)
    if not floor < belly:
        raise ModelError(
            f"no posture was found to stand in: {source}; its feet reach "
            f"{1e3 * (belly - lowest):.0f} mm below its body, give it a keyframe"
        )
    angles: dict[str, float] = {}
    for limb, table in zip(limbs, tables, strict=True):
        angles |= _lowered(pose, limb, table, floor, source)
    return angles


def _within(pose: Pose, joint: str) -> Array:
    low, high = pose.span(joint)
    keep = MARGIN * (high - low)
    return np.linspace(low + keep, high - keep, GRID)


def _table(pose: Pose, limb: Limb) -> Array:
    """Rows of lift angle, held angle, height of the foot, lean of the shank, reach."""
    before = pose.data.qpos.copy()
    hold = limb.hold[-1:]
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
    foot = pose.model.geom(limb.foot).id

    def above(lift: float) -> float:
        pose.turn(held | {limb.lift: lift})
        return float(pose.bottom(foot)[2]) - floor

    first, last = above(low), above(high)
    if first * last > 0:
        raise ModelError(
            f"no posture was found to stand in: {source}; {limb.foot!r} cannot be put "
            "on one floor with the others, give it a keyframe 'start'"
        )
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        low, high = (middle, high) if above(middle) * first > 0 else (low, middle)
    return held | {limb.lift: float((low + high) / 2)}


STIFF = 2500.0  # times the torque that a leg bears, for a radian
FASTEST = 700.0  # [rad/s] of a servo's own frequency, as that of the shipped robots


def servo_for(robot: Robot) -> Servo:
    """A servo that suits all leg joints of a robot."""
    pose = Pose.at(robot.model, robot.model.body(robot.root).id, robot.start_qpos)
    hips = np.array([pose.data.joint(name).xanchor[:2] for name in robot.swing_joints])
    feet = Kinematics(robot).standing.feet
    arm = float(np.linalg.norm(feet - hips, axis=1).max())
    return drafted_servo(pose, robot.card.joints, arm, len(robot.legs))


def fitting_rotor(robot: Robot) -> float:
    """Reflected inertia of a motor that could carry a robot [kg m^2]."""
    return servo_for(robot).stiffness / FASTEST**2


def drafted_servo(pose: Pose, joints: Sequence[str], arm: float, legs: int) -> Servo:
    """A servo for some joints of a robot that stands, critically damped.

    Half of the legs are to bear the weight with little sag; the arm is the distance of
    a foot from its hip [m]. The physics step cannot follow the inertia of a mere leg:
    joints without the rotor of a stiff servo, as in many a URDF, get that as well.
    """
    model = pose.model
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_crb(model, pose.data)
    mujoco.mj_fullM(model, pose.data, inertia)
    own = np.diag(inertia)[[int(model.joint(name).dofadr[0]) for name in joints]]
    weight = 9.81 * float(model.body_subtreemass[pose.root])
    stiffness = STIFF * weight * arm / (legs / 2)
    armature = max(stiffness / FASTEST**2 - float(own.min()), 0.0)
    critical = 2 * float(np.sqrt(stiffness * (np.median(own) + armature)))
    return Servo(stiffness, critical, armature=armature)


def servo_stiffness(model: mujoco.MjModel, joint: str) -> float:
    """Stiffness of the position servo that drives a joint, 0 if none does [N m/rad]."""
    gain, bias = model.actuator_gainprm[:, 0], model.actuator_biasprm[:, 1]
    for i in actuators_of(model, joint):
        if is_position_servo(gain[i], bias[i]):
            return float(gain[i] * model.actuator_gear[i, 0] ** 2)
    return 0.0
