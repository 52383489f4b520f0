"""Checks that model and card describe a robot that can walk; see `checks.toml`."""

from collections import Counter
from collections.abc import Iterator
from itertools import product

import mujoco
import numpy as np

from models.contact.kinematics import UPRIGHT, Kinematics
from models.description.actuators import actuators_of
from models.description.card import LegCard
from models.description.compiled import joints_above, root_body
from models.description.robot import Robot
from models.errors import refusals
from planner.support import did_you_mean

FARTHEST = 1e6  # [m] from the origin or frame; beyond, numbers lose millimetres
Problem = tuple[str, dict[str, object]]  # its sentence, and facts that are in it
_wrong = refusals("models", "checks.toml")


def check_parts(robot: Robot) -> None:
    """Refuse a card whose legs do not match the model."""
    model = robot.model
    if not model.body(root_body(model, robot.path)).name:
        raise _wrong("unnamed", robot.path)
    _check_names(robot)
    if (farthest := np.abs(robot.start_qpos).max()) > FARTHEST:
        raise _wrong("far_start", robot.path, farthest=farthest)
    check_places(model, str(robot.path))
    for number, leg in robot.card.legs.items():
        for problem, facts in _part_problems(model, leg):
            raise _wrong(problem, robot.path, leg=number, **facts)


def check_places(model: mujoco.MjModel, source: str) -> None:
    """Refuse a model with a part so far away that its place has no millimetres."""
    for kind, places in (("body", model.body_pos), ("geom", model.geom_pos)):
        away = np.abs(places).max(axis=1)
        if away.max(initial=0.0) > FARTHEST:
            name = getattr(model, kind)(int(away.argmax())).name
            raise _wrong("far_part", source, kind=kind, name=name, away=away.max())


def _check_names(robot: Robot) -> None:
    """Refuse parts that the model lacks, or that belong to two legs."""
    model, card = robot.model, robot.card
    geoms = map(model.geom, range(model.ngeom))
    joints = map(model.joint, range(model.njnt))
    free = mujoco.mjtJoint.mjJNT_FREE
    known = {
        "geom": {g.name for g in geoms if g.name and model.body_weldid[g.bodyid[0]]},
        "joint": {j.name for j in joints if j.name and j.type[0] != free},
    }
    named = []
    for leg in card.legs.values():
        named += [("joint", name) for name in leg.joints]
        named += [("geom", name) for name in leg.foot]
    every = [*named, *(("joint", name) for name in card.start)]
    if missing := [part for part in every if part[1] not in known[part[0]]]:
        lacks = ", ".join(f"{kind} {name!r}" for kind, name in missing[:9])
        kind, name = missing[0]
        similar = did_you_mean(name, sorted(known[kind]))
        raise _wrong("lacking", robot.path, lacks=lacks, similar=similar)
    (kind, name), times = Counter(named).most_common(1)[0]
    if times > 1:
        raise _wrong("twice", robot.path, kind=kind, name=name)


def _part_problems(model: mujoco.MjModel, leg: LegCard) -> Iterator[Problem]:
    """What is wrong with a leg whose parts exist, and what to do about it."""
    hinge = mujoco.mjtJoint.mjJNT_HINGE
    for joint in leg.joints:
        if model.joint(joint).type != hinge:
            yield "no_hinge", {"joint": joint}
        parts = model.joint(joint), *map(model.actuator, actuators_of(model, joint))
        laws = "damping", "frictionloss", "stiffness", "armature"
        for part, name in product(parts, laws):
            value = float(getattr(part, name, [0.0])[0])
            if not 0 <= value <= 1e6:  # [N m/rad]; no joint has more
                yield "drives", {"joint": joint, "name": name, "value": value}
    for joint, angle in leg.hold.items():
        low, high = model.joint(joint).range
        if model.jnt_limited[model.joint(joint).id] and not low <= angle <= high:
            span = {"low": low, "high": high}
            yield "held_outside", {"joint": joint, "angle": angle, **span}
    for foot in leg.foot:
        above = joints_above(model, int(model.geom_bodyid[model.geom(foot).id]))
        names = [model.joint(joint).name for joint in above]
        if still := [joint for joint in leg.joints if joint not in names]:
            others = ", ".join(map(repr, names)) or "none"
            yield "still", {"foot": foot, "joint": still[0], "others": others}
        if loose := [name for name in names if name not in leg.joints]:
            yield "loose", {"foot": foot, "joint": loose[0]}


STEEP = np.deg2rad(20)  # largest angle between a swing axis and the vertical
UNEVEN_FEET = 0.02  # of the stance's size; tolerance of the feet's heights
BEYOND = 1e-6  # [rad] by which a start may be out of range
CLEAR = 2e-4  # [m]; least rise of a lifted foot, more than soft feet sink in


def check_posture(robot: Robot) -> None:
    """Refuse a robot that does not start on its feet, or cannot lift or swing them."""
    kinematics = Kinematics(robot)
    for problems in (_badly_standing, _cannot_swing, _cannot_lift):  # gravest first
        for problem, facts in problems(kinematics):
            raise _wrong(problem, robot.path, **facts)


def _badly_standing(kinematics: Kinematics) -> Iterator[Problem]:
    """Problems of the start."""
    robot = kinematics.robot
    place = robot.root_address_in(robot.model)
    quat = robot.start_qpos[place + 3 : place + 7]
    up = np.zeros(3)
    mujoco.mju_rotVecQuat(up, np.array([0.0, 0.0, 1.0]), quat)
    tilt = float(np.arccos(np.clip(up[2], -1, 1)))
    if tilt > UPRIGHT:
        down = "upside down" if tilt > np.deg2rad(100) else "tilted"
        yield "tilted", {"down": down, "root": robot.root, "tilt": np.rad2deg(tilt)}
    for joint in robot.card.joints:
        (low, high), angle = robot.span(joint), robot.standing_angle(joint)
        if not low - BEYOND <= angle <= high + BEYOND:
            yield "outside", {"joint": joint, "angle": angle, "low": low, "high": high}
    feet, height = kinematics.standing.feet, kinematics.standing.height
    highest, lowest = int(height.argmax()), int(height.argmin())
    above = height[highest] - float(kinematics.center_of_mass[2])
    if above >= 0:
        yield "on_its_back", {"leg": robot.legs[highest], "above": 1e3 * above}
    uneven = height[highest] - height[lowest]
    if uneven > UNEVEN_FEET * float(np.ptp(feet, axis=0).max()):
        legs = {"high": robot.legs[highest], "low": robot.legs[lowest]}
        yield "uneven", {"apart": 1e3 * uneven, **legs}


def _cannot_swing(kinematics: Kinematics) -> Iterator[Problem]:
    robot = kinematics.robot
    for leg, joint in zip(robot.legs, robot.swing_joints, strict=True):
        axis, _ = kinematics.hinge(joint)
        lean = float(np.arccos(min(abs(axis[2]), 1.0)))
        if lean > STEEP:
            yield "leaning", {"leg": leg, "joint": joint, "lean": np.rad2deg(lean)}
    for group, (low, high) in robot.swing_range.items():
        if not low < 0 < high:
            yield "at_end", {"group": group, "low": low, "high": high}


def _cannot_lift(kinematics: Kinematics) -> Iterator[Problem]:
    robot = kinematics.robot
    wanted = robot.card.lift_angle
    rises = kinematics.rise(np.array([wanted, -wanted])).T
    for leg, (rise, other_way) in zip(robot.legs, rises, strict=True):
        joint, sign = robot.card.legs[leg].lift, robot.card.legs[leg].raise_sign
        if rise < CLEAR < other_way:
            yield "lowers", {"leg": leg, "joint": joint, "sign": sign, "other": -sign}
        if rise < CLEAR:
            at = {"rise": 1e3 * rise, "wanted": wanted}
            yield "stays", {"leg": leg, "joint": joint, **at}
    if wanted > kinematics.farthest_lift + 1e-9:
        most = {"most": kinematics.farthest_lift, "highest": kinematics.highest}
        yield "too_far", {"wanted": wanted, **most}
