"""The text of a drafted card."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from models.adoption.anatomy import Limb, Pose
from models.adoption.gait_draft import GaitDraft
from models.adoption.standing import joint_span
from models.description.card import Servo

LIFT = 0.3  # [rad]


def card_text(
    pose: Pose,
    limbs: Sequence[Limb],
    gait: GaitDraft,
    angles: Mapping[str, float],
    servo: Servo | None,
) -> str:
    """The card of a robot.

    Args:
        pose: The model as it starts.
        limbs: Its legs.
        gait: How they walk.
        angles: Joint angles in which it starts [rad].
        servo: Of joints without one; None if all have one.

    Returns:
        TOML.
    """
    lines = [
        'description = "Drafted by stratawalk adopt."',
        f"lift_angle = {_lift_angle(pose, limbs):.4g}",
        *(f"{key} = {value:g}" for key, value in gait.settings.items()),
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
    lines += gait.lines
    if servo is not None:
        said = (f"{key} = {value:.4g}" for key, value in servo.settings.items())
        lines += ["", "[servo]", *said]
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
