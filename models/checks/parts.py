"""Checks that the parts a card names exist and that they form legs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import mujoco
import numpy as np

from models.description.card import LegCard
from models.description.compiled import joints_above, root_body
from models.description.robot import Robot
from models.errors import ModelError
from planner.support import did_you_mean

FARTHEST = 1e6  # [m] from the origin or frame; beyond, numbers lose millimetres


def check_parts(robot: Robot) -> None:
    """Refuse a card whose legs do not match the model.

    Raises:
        ModelError: Naming the parts that are missing, shared, or in the wrong place.
    """
    root = root_body(robot.model, robot.path)
    if not robot.model.body(root).name:
        raise ModelError(
            f"the body with the free joint has no name: {robot.path}; give it one"
        )
    _check_names(robot)
    if np.abs(robot.start_qpos).max() > FARTHEST:
        raise ModelError(
            f"it starts {np.abs(robot.start_qpos).max():.3g} m or rad away: "
            f"{robot.path}; correct keyframe 'start', or where its body is"
        )
    _require_near(robot)
    for number, leg in robot.card.legs.items():
        for problem in _problems(robot.model, leg):
            raise ModelError(f"leg {number}: {robot.path}; {problem}")


def _require_near(robot: Robot) -> None:
    """Refuse bodies and geoms that are placed beyond what numbers can resolve."""
    model = robot.model
    for kind, places in (("body", model.body_pos), ("geom", model.geom_pos)):
        away = np.abs(places).max(axis=1)
        if away.max() > FARTHEST:
            name = getattr(model, kind)(int(away.argmax())).name
            raise ModelError(
                f"{kind} {name!r} is {away.max():.3g} m away from its frame: "
                f"{robot.path}; correct its pos"
            )


def _check_names(robot: Robot) -> None:
    named = [part for leg in robot.card.legs.values() for part in _parts(leg)]
    started = [("joint", name) for name in robot.card.start]
    if missing := [
        part for part in (*named, *started) if part[1] not in _known(robot, part[0])
    ]:
        lacks = ", ".join(f"{kind} {name!r}" for kind, name in missing)
        raise ModelError(
            f"the card names what the model lacks: {robot.path}; {lacks}; "
            f"{did_you_mean(missing[0][1], sorted(_known(robot, missing[0][0])))}"
        )
    if shared := [part for part, times in Counter(named).items() if times > 1]:
        kind, name = shared[0]
        raise ModelError(
            f"{kind} {name!r} is named twice: {robot.path}; every {kind} belongs to "
            "one leg, and there to one task"
        )


def _parts(leg: LegCard) -> list[tuple[str, str]]:
    joints = [("joint", name) for name in leg.joints]
    return joints + [("geom", name) for name in leg.foot]


def _known(robot: Robot, kind: str) -> set[str]:
    """Named joints or geoms of the robot, the free joint left out."""
    model = robot.model
    if kind == "geom":
        geoms = (model.geom(i) for i in range(model.ngeom))
        return {g.name for g in geoms if g.name and model.body_weldid[g.bodyid[0]]}
    joints = (model.joint(i) for i in range(model.njnt))
    free = mujoco.mjtJoint.mjJNT_FREE
    return {j.name for j in joints if j.name and j.type[0] != free}


def _problems(model: mujoco.MjModel, leg: LegCard) -> Iterator[str]:
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
