"""The draft of a card, together with the guesses that it rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from models.adoption.anatomy import Limb, Pose, find_limbs
from models.adoption.pivots import Stand, posed, two_groups
from models.adoption.servo import drafted_servo, has_servo
from models.adoption.source import Source
from models.adoption.standing import joint_span, standing_angles, stands
from models.description.compiled import (
    compile_model,
    named,
    root_body,
)
from models.description.robot import START
from planner import Array

LIFT = 0.3  # [rad]


@dataclass(frozen=True)
class Draft:
    """A card and the reasons for what it says.

    Attributes:
        card: Text of the card, TOML.
        guesses: What was guessed, one line each.
        limbs: Legs in the order of their numbers, where the robot starts.
        stands: The two groups at their pivots.
    """

    card: str
    guesses: tuple[str, ...]
    limbs: tuple[Limb, ...]
    stands: tuple[Stand, Stand]


def draft_card(source: Source) -> Draft:
    """Draft a card for a robot.

    Args:
        source: Its file.

    Raises:
        ModelError: It has no legs that this project can move, no groups that stand, or
            no posture to stand in; it says which.
    """
    spec = source.spec()
    named(spec)
    model = compile_model(spec, str(source.given))
    root = root_body(model, source.given)
    pose = Pose.at(model, root, _start(model))
    guesses = []
    limbs = find_limbs(pose, str(source.given))
    angles: dict[str, float] = {}
    if not stands(pose, limbs):
        angles = standing_angles(pose, limbs, str(source.given))
        pose.turned(angles)
        guesses.append("its feet are not on one floor as it is given: knees were bent")
    limbs = _numbered(find_limbs(pose, str(source.given)))
    weight = pose.weight[:2]
    ways = two_groups(limbs, weight, str(source.given))
    room = np.array([_room(pose, limb) for limb in limbs])
    pair = posed(limbs, ways, weight, room, str(source.given))
    for stand in pair:
        for i, turn in zip(stand.legs, stand.turns, strict=True):
            joint = limbs[i].swing
            standing = float(pose.data.joint(joint).qpos[0])
            angles[joint] = standing + limbs[i].turn * float(turn)
    pose.turned(angles)
    servo = _servo(pose, limbs)
    text = _card(pose, limbs, pair, angles, servo)
    return Draft(text, (*guesses, *_said(limbs, pair, servo)), limbs, pair)


def _start(model: mujoco.MjModel) -> Array:
    names = [model.key(i).name for i in range(model.nkey)]
    key = next((names.index(name) for name in START if name in names), None)
    return np.array(model.qpos0 if key is None else model.key_qpos[key])


def _numbered(limbs: Sequence[Limb]) -> tuple[Limb, ...]:
    """Pairs from front to back, odd numbers left; around the body if not in pairs."""
    middle = np.mean([limb.toe[:2] for limb in limbs], axis=0)
    left = sorted((m for m in limbs if m.toe[1] > middle[1]), key=lambda m: -m.toe[0])
    right = sorted((m for m in limbs if m.toe[1] <= middle[1]), key=lambda m: -m.toe[0])
    if len(left) == len(right):
        return tuple(m for pair in zip(left, right, strict=True) for m in pair)

    def bearing(limb: Limb) -> float:
        x, y = limb.toe[:2] - middle
        return float(np.arctan2(y, x) % (2 * np.pi))

    return tuple(sorted(limbs, key=bearing))


def _room(pose: Pose, limb: Limb) -> tuple[float, float]:
    """How far a leg may turn clockwise and anticlockwise from where it is [rad]."""
    low, high = joint_span(pose, limb.swing)
    angle = float(pose.data.joint(limb.swing).qpos[0])
    ends = limb.turn * (low - angle), limb.turn * (high - angle)
    return min(ends), max(ends)


def _servo(pose: Pose, limbs: Sequence[Limb]) -> tuple[float, float] | None:
    """Stiffness and damping for joints without a position servo; None if all have one.

    Args:
        pose: The model as it stands.
        limbs: Its legs.
    """
    joints = [joint for limb in limbs for joint in limb.joints]
    if all(has_servo(pose.model, joint) for joint in joints):
        return None
    arm = max(float(np.linalg.norm(limb.toe[:2] - limb.hip)) for limb in limbs)
    return drafted_servo(pose, joints, arm, len(limbs))


def _card(
    pose: Pose,
    limbs: Sequence[Limb],
    pair: Sequence[Stand],
    angles: Mapping[str, float],
    servo: tuple[float, float] | None,
) -> str:
    lines = [
        'description = "Drafted by stratawalk adopt."',
        f"lift_angle = {_lift_angle(pose, limbs):.4g}",
        "",
        "[start]  # joint angles in which it stands [rad]",
        *(f"{_key(joint)} = {angle:.9g}" for joint, angle in angles.items()),
    ]
    for number, limb in enumerate(limbs, start=1):
        held = {joint: float(pose.data.joint(joint).qpos[0]) for joint in limb.hold}
        hold = ", ".join(f"{_key(joint)} = {a:.9g}" for joint, a in held.items())
        lines += [
            "",
            f"[leg.{number}]",
            f"swing = {_text(limb.swing)}",
            f"lift = {_text(limb.lift)}",
            f"raise = {limb.up:g}",
            f"foot = [{_text(limb.foot)}]",
            f"hold = {{ {hold} }}" if hold else "hold = {}",
        ]
    for name, stand in zip("12", pair, strict=True):
        sense = -1 if stand.pivot[1] > 0 else 1  # forward for a positive angle
        gains = ", ".join(
            f"{i + 1} = {sense * limbs[i].turn * gain:.9g}"
            for i, gain in zip(stand.legs, stand.gains, strict=True)
        )
        x, y = stand.pivot
        lines += [
            "",
            f"[group.{name}]  # turns the body about ({x:.4f}, {y:.4f})",
            f"legs = {{ {gains} }}",
        ]
    lines += ["", "[gait]", 'strata = ["12", "1", "12", "2", "12"]']
    if servo is not None:
        lines += [
            "",
            "[servo]",
            f"stiffness = {servo[0]:.4g}",
            f"damping = {servo[1]:.4g}",
        ]
    return "\n".join([*lines, ""])


def _lift_angle(pose: Pose, limbs: Sequence[Limb]) -> float:
    """An angle that all lift joints have left, 0.3 rad if they can."""
    rooms = []
    for limb in limbs:
        low, high = joint_span(pose, limb.lift)
        angle = float(pose.data.joint(limb.lift).qpos[0])
        rooms.append(high - angle if limb.up > 0 else angle - low)
    return min(LIFT, 0.95 * min(rooms))


def _key(name: str) -> str:
    bare = name.replace("_", "").replace("-", "")
    return name if bare.isascii() and bare.isalnum() else _text(name)


def _text(name: str) -> str:
    escaped = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _said(
    limbs: Sequence[Limb],
    pair: Sequence[Stand],
    servo: tuple[float, float] | None,
) -> list[str]:
    """What was guessed, in sentences."""
    held = sum(len(limb.hold) for limb in limbs)
    said = [
        f"{len(limbs)} legs: joints nearest to the vertical swing, those that raise "
        f"the foot most lift, {held} further joints are held"
    ]
    for name, stand in zip("12", pair, strict=True):
        legs = " ".join(str(i + 1) for i in stand.legs)
        x, y = stand.pivot
        most = np.rad2deg(np.abs(stand.turns).max())
        said.append(
            f"group {name}, legs {legs}: turned by up to {most:.0f} degrees to meet at "
            f"({x:.3f}, {y:.3f}) m, swings {stand.swing:.2f} rad either way"
        )
    if servo is not None:
        said.append(
            f"servos: joints without one hold with {servo[0]:.4g} N m/rad and "
            f"{servo[1]:.4g} N m s/rad"
        )
    return said
