"""How far groups of legs may swing before their parts touch one another.

All angles of both groups are tried together, on the ground and lifted, on a grid.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from itertools import product

import mujoco

from models.adoption.anatomy import Limb, Pose
from models.errors import ModelError

TRIED_ANGLES = 16  # angles that are tried, on each side
CLEARANCE = 1e-3  # [m] that parts keep from one another

Swings = Mapping[int, float]  # place of a limb -> its joint's angle per group's angle


@dataclass(frozen=True)
class Reach:
    """How far groups may swing either way."""

    swing: float  # [rad]
    reason: str  # what lies beyond, in words
    touching: bool  # whether it is another leg, and no joint's range


def free_reach(
    pose: Pose,
    limbs: Sequence[Limb],
    groups: Sequence[Swings],
    lift: float,
    source: str,
) -> Reach:
    """The largest swing at which nothing touches that does not where the robot stands.

    A lifted group is raised by an angle [rad]. Legs that cannot swing at all are
    refused.
    """
    rooms = {
        limbs[place].swing: _room(pose, limbs[place].swing) / abs(gain)
        for group in groups
        for place, gain in group.items()
    }
    joint = min(rooms, key=rooms.__getitem__)
    farthest = rooms[joint]
    trial = _Trial(pose, limbs, groups, lift)
    if first := trial.first_touching(farthest):
        level, (one, other) = first
        if level <= 1:
            raise ModelError(
                f"its legs cannot swing: {source}; {one!r} and {other!r} touch at "
                "once, make them smaller, or mount the legs farther apart"
            )
        swing = farthest * (level - 1) / TRIED_ANGLES
        return Reach(swing, f"beyond which {one!r} and {other!r} would touch", True)
    return Reach(farthest, f"which is the range of {joint!r}", False)


def _room(pose: Pose, joint: str) -> float:
    low, high = pose.span(joint)
    return min(high - pose.angle(joint), pose.angle(joint) - low)


class _Trial:
    """Parts of a robot that touch at given angles of two groups."""

    def __init__(
        self, pose: Pose, limbs: Sequence[Limb], groups: Sequence[Swings], lift: float
    ) -> None:
        model = copy(pose.model)
        model.geom_margin[:] = CLEARANCE
        self._pose = Pose(model, mujoco.MjData(model), pose.root)
        self._pose.data.qpos[:] = pose.data.qpos
        self._rest = [(pose.angle(m.swing), pose.angle(m.lift)) for m in limbs]
        self._limbs, self._groups, self._lift = limbs, groups, lift
        self._always = set(self._pairs((0.0, 0.0), (False, False)))

    def first_touching(self, farthest: float) -> tuple[int, tuple[str, str]] | None:
        """The least level at which parts touch, and which; None up to the farthest."""
        sides = range(-TRIED_ANGLES, TRIED_ANGLES + 1)
        levels = sorted(product(sides, repeat=2), key=lambda at: max(map(abs, at)))
        name = self._pose.model.geom
        for one, other in levels:
            angles = farthest * one / TRIED_ANGLES, farthest * other / TRIED_ANGLES
            for raised in ((False, False), (True, False), (False, True)):
                for a, b in self._pairs(angles, raised):
                    if (a, b) not in self._always:
                        return max(abs(one), abs(other)), (name(a).name, name(b).name)
        return None

    def _pairs(
        self, swing: tuple[float, float], raised: tuple[bool, bool]
    ) -> Iterator[tuple[int, int]]:
        """Geoms of the robot that touch at angles of the groups [rad]."""
        angles = {}
        for group, angle, up in zip(self._groups, swing, raised, strict=True):
            for place, gain in group.items():
                limb = self._limbs[place]
                turned, lifted = self._rest[place]
                angles[limb.swing] = turned + gain * angle
                angles[limb.lift] = lifted + limb.up * self._lift * up
        self._pose.turn(angles)
        model, data = self._pose.model, self._pose.data
        mujoco.mj_collision(model, data)
        for contact in data.contact[: data.ncon]:
            one, other = sorted(int(geom) for geom in contact.geom)
            roots = model.body_rootid[model.geom_bodyid[[one, other]]]
            if (roots == self._pose.root).all() and not contact.exclude:
                yield one, other
