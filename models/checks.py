"""Checks that a model and its card describe a robot that can walk."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import mujoco
import numpy as np

from models.contact.kinematics import UPRIGHT, Kinematics
from models.description.card import LegCard
from models.description.compiled import joints_above, root_body
from models.description.robot import Robot
from models.errors import ModelError
from planner.support import did_you_mean

FARTHEST = 1e6  # [m] from the origin or frame; beyond, numbers lose millimetres


def check_parts(robot: Robot) -> None:
    """Refuse a card whose legs do not match the model."""
    model = robot.model
    if not model.body(root_body(model, robot.path)).name:
        raise ModelError(f"the free body has no name: {robot.path}; give it one")
    _check_names(robot)
    if (farthest := np.abs(robot.start_qpos).max()) > FARTHEST:
        raise ModelError(
            f"it starts {farthest:.3g} m or rad away: {robot.path}; correct keyframe "
            "'start', or where its body is"
        )
    check_places(model, str(robot.path))
    for number, leg in robot.card.legs.items():
        for problem in _part_problems(model, leg):
            raise ModelError(f"leg {number}: {robot.path}; {problem}")


def check_places(model: mujoco.MjModel, source: str) -> None:
    """Refuse a model with a part so far away that its place has no millimetres."""
    for kind, places in (("body", model.body_pos), ("geom", model.geom_pos)):
        away = np.abs(places).max(axis=1)
        if away.max(initial=0.0) > FARTHEST:
            name = getattr(model, kind)(int(away.argmax())).name
            raise ModelError(
                f"{kind} {name!r} is {away.max():.3g} m away from its frame: {source}; "
                "correct its pos"
            )


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
        lacks = ", ".join(f"{kind} {name!r}" for kind, name in missing)
        kind, name = missing[0]
        raise ModelError(
            f"the card names what the model lacks: {robot.path}; {lacks}; "
            f"{did_you_mean(name, sorted(known[kind]))}"
        )
    (kind, name), times = Counter(named).most_common(1)[0]
    if times > 1:
        raise ModelError(
            f"{kind} {name!r} is named twice: {robot.path}; every {kind} belongs to "
            "one leg, and there to one task"
        )


def _part_problems(model: mujoco.MjModel, leg: LegCard) -> Iterator[str]:
    """What is wrong with a leg whose parts exist, and what to do about it."""
    hinge = mujoco.mjtJoint.mjJNT_HINGE
    for joint in leg.joints:
        if model.joint(joint).type != hinge:
            yield f"joint {joint!r} is not a hinge; legs swing, lift and hold by hinges"
    for joint, angle in leg.hold.items():
        low, high = model.joint(joint).range
        if model.jnt_limited[model.joint(joint).id] and not low <= angle <= high:
            yield (
                f"joint {joint!r} is to be held at {angle} rad, outside its range; "
                f"hold it between {low:.4g} and {high:.4g}"
            )
    for foot in leg.foot:
        above = joints_above(model, int(model.geom_bodyid[model.geom(foot).id]))
        names = [model.joint(joint).name for joint in above]
        if still := [joint for joint in leg.joints if joint not in names]:
            yield (
                f"foot {foot!r} does not move with joint {still[0]!r}; "
                f"it moves with {', '.join(map(repr, names)) or 'none'}"
            )
        if loose := [name for name in names if name not in leg.joints]:
            yield (
                f"foot {foot!r} moves with joint {loose[0]!r}, which the card leaves "
                f"loose; hold it: hold = {{ {loose[0]} = 0.0 }}"
            )


STEEP = np.deg2rad(20)  # largest angle between a swing axis and the vertical
UNEVEN_FEET = 0.02  # of the stance's size; tolerance of the feet's heights
BEYOND = 1e-6  # [rad] by which a start may be out of range
CLEAR = 2e-4  # [m]; least rise of a lifted foot, more than soft feet sink in


def check_posture(robot: Robot) -> None:
    """Refuse a robot that does not start on its feet, or cannot lift or swing them."""
    kinematics = Kinematics(robot)
    for problems in (_badly_standing, _cannot_swing, _cannot_lift):  # gravest first
        for problem, remedy in problems(kinematics):
            raise ModelError(f"{problem}: {robot.path}; {remedy}")


def _badly_standing(kinematics: Kinematics) -> Iterator[tuple[str, str]]:
    """Problems of the start, each with its remedy."""
    robot = kinematics.robot
    place = robot.root_address_in(robot.model)
    quat = robot.start_qpos[place + 3 : place + 7]
    up = np.zeros(3)
    mujoco.mju_rotVecQuat(up, np.array([0.0, 0.0, 1.0]), quat)
    tilt = float(np.arccos(np.clip(up[2], -1, 1)))
    if tilt > UPRIGHT:
        down = "upside down" if tilt > np.pi / 2 else "tilted"
        yield (
            f"the robot starts {down}: the z axis of body {robot.root!r} is "
            f"{np.rad2deg(tilt):.3g} degrees off the vertical",
            "turn that body upright, where it is defined or in keyframe 'start'",
        )
    for joint in robot.card.joints:
        (low, high), angle = robot.span(joint), robot.standing_angle(joint)
        if not low - BEYOND <= angle <= high + BEYOND:
            yield (
                f"joint {joint!r} starts at {angle:.4g} rad, outside the range of "
                f"it and its servos, {low:.4g} to {high:.4g}",
                "start inside it: correct keyframe 'start', or [start] in the card",
            )
    feet, height = kinematics.standing.feet, kinematics.standing.height
    highest, lowest = int(height.argmax()), int(height.argmin())
    above = height[highest] - float(kinematics.center_of_mass[2])
    if above >= 0:
        yield (
            f"it does not start on its feet: that of leg {robot.legs[highest]} is "
            f"{1e3 * above:.0f} mm above the centre of mass",
            "put the legs down in keyframe 'start', or correct the foot",
        )
    uneven = height[highest] - height[lowest]
    if uneven > UNEVEN_FEET * float(np.ptp(feet, axis=0).max()):
        yield (
            f"its feet do not start on one floor: leg {robot.legs[highest]} ends "
            f"{1e3 * uneven:.1f} mm above leg {robot.legs[lowest]}",
            "correct the angles in keyframe 'start', or those held by the card",
        )


def _cannot_swing(kinematics: Kinematics) -> Iterator[tuple[str, str]]:
    robot = kinematics.robot
    for leg, joint in zip(robot.legs, robot.swing_joints, strict=True):
        axis, _ = kinematics.hinge(joint)
        lean = float(np.arccos(min(abs(axis[2]), 1.0)))
        if lean > STEEP:
            yield (
                f"leg {leg}: the axis of swing joint {joint!r} is "
                f"{np.rad2deg(lean):.0f} degrees off the vertical",
                "legs swing about vertical axes; was the lift joint meant?",
            )
    for group, (low, high) in robot.swing_range.items():
        if not low < 0 < high:
            yield (
                f"group {group} stands at the end of its swing, which goes from "
                f"{low:.3g} to {high:.3g} rad",
                "stand inside the ranges of its joints and servos",
            )


def _cannot_lift(kinematics: Kinematics) -> Iterator[tuple[str, str]]:
    robot = kinematics.robot
    wanted = robot.card.lift_angle
    rises = kinematics.rise(np.array([wanted, -wanted])).T
    for leg, (rise, other_way) in zip(robot.legs, rises, strict=True):
        joint, sign = robot.card.legs[leg].lift, robot.card.legs[leg].raise_sign
        if rise < CLEAR < other_way:
            yield (
                f"leg {leg}: raise = {sign:g} makes joint {joint!r} lower its foot",
                f"write raise = {-sign:g}",
            )
        if rise < CLEAR:
            yield (
                f"leg {leg}: joint {joint!r} raises its foot by {1e3 * rise:.1f} mm at "
                f"lift_angle = {wanted}",
                "lift by a joint that raises the foot, or by a larger angle",
            )
    if wanted > kinematics.farthest_lift + 1e-9:
        yield (
            f"lift_angle = {wanted} is beyond the range of its lift joints or servos",
            f"give at most {kinematics.farthest_lift:.4g} rad, which raises the feet "
            f"by {kinematics.highest:.4f} m",
        )
