"""Checks of a robot's posture: it stands upright, and its legs can swing and lift.

Only the positions at the start are checked. Whether the robot remains standing is
tested in the physics, by `sim`.
"""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from models.contact.kinematics import Kinematics
from models.contact.lifting import Lifting
from models.description.robot import Robot
from models.errors import ModelError

UPRIGHT = np.deg2rad(3)  # smaller tilts change lengths by less than 0.2 %
STEEP = np.deg2rad(20)  # largest angle between a swing axis and the vertical
APART = 0.02  # of the stance's size; tolerance of the feet's heights
BEYOND = 1e-6  # [rad] by which a start may be out of range
CLEAR = 2e-4  # [m]; least rise of a lifted foot, more than soft feet sink in


def check_posture(robot: Robot) -> None:
    """Refuse a robot that does not start on its feet, or cannot lift or swing them.

    Raises:
        ModelError: If so, with the number that says so and what to do about it.
    """
    for problem in _problems(Kinematics(robot)):
        raise ModelError(f"{problem[0]}: {robot.path}; {problem[1]}")


def _problems(kinematics: Kinematics) -> Iterator[tuple[str, str]]:
    """Every problem with its remedy, the gravest first."""
    yield from _tilted(kinematics.robot)
    yield from _out_of_range(kinematics.robot)
    yield from _off_its_feet(kinematics)
    yield from _cannot_swing(kinematics)
    yield from _cannot_lift(kinematics)


def _tilted(robot: Robot) -> Iterator[tuple[str, str]]:
    quat = robot.start_qpos[robot.root_address + 3 : robot.root_address + 7]
    up = np.zeros(3)
    mujoco.mju_rotVecQuat(up, np.array([0.0, 0.0, 1.0]), quat)
    tilt = float(np.arccos(np.clip(up[2], -1, 1)))
    if tilt > UPRIGHT:
        down = "upside down" if tilt > np.pi / 2 else "tilted"
        yield (
            f"it starts {down}: the z axis of body {robot.root!r} is "
            f"{np.rad2deg(tilt):.3g} degrees off the vertical",
            "turn that body upright, where it is defined or in keyframe 'start'",
        )


def _out_of_range(robot: Robot) -> Iterator[tuple[str, str]]:
    for joint in robot.card.joints:
        (low, high), angle = robot.span(joint), robot.standing_angle(joint)
        if not low - BEYOND <= angle <= high + BEYOND:
            yield (
                f"joint {joint!r} starts at {angle:.4g} rad, outside the range of "
                f"it and its servos, {low:.4g} to {high:.4g}",
                "start inside it: correct keyframe 'start', or [start] in the card",
            )


def _off_its_feet(kinematics: Kinematics) -> Iterator[tuple[str, str]]:
    stance = kinematics.standing
    legs, height = kinematics.robot.legs, stance.height
    highest, lowest = int(height.argmax()), int(height.argmin())
    weight = float(kinematics.center_of_mass[2])
    if height[highest] >= weight:
        yield (
            f"it does not start on its feet: that of leg {legs[highest]} is "
            f"{1e3 * (height[highest] - weight):.0f} mm above the centre of mass",
            "put the legs down in keyframe 'start', or correct the foot",
        )
    size = float(np.ptp(stance.feet, axis=0).max())
    if height[highest] - height[lowest] > APART * size:
        yield (
            f"its feet do not start on one floor: leg {legs[highest]} ends "
            f"{1e3 * (height[highest] - height[lowest]):.1f} mm above leg "
            f"{legs[lowest]}",
            "correct the angles in keyframe 'start', or those held by the card",
        )


def _cannot_swing(kinematics: Kinematics) -> Iterator[tuple[str, str]]:
    robot = kinematics.robot
    for leg in robot.legs:
        joint = robot.card.legs[leg].swing
        lean = float(np.arccos(min(abs(kinematics.axis(joint)[2]), 1.0)))
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
    robot, lifting = kinematics.robot, Lifting(kinematics)
    wanted = robot.card.lift_angle
    rises = lifting.rise(np.array([wanted, -wanted])).T
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
    if wanted > lifting.farthest + 1e-9:
        yield (
            f"lift_angle = {wanted} is beyond the range of its lift joints or servos",
            f"give at most {lifting.farthest:.4g} rad, which raises the feet by "
            f"{lifting.highest:.4f} m",
        )
