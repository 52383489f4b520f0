"""Soles: the lowest points of the feet's geoms when the robot stands.

A round geom touches the floor vertically below a point that is fixed in the leg,
whichever way the leg turns. A geom with edges or corners touches with these themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from models.contact.cores import Core, Geom, core_of, ends
from models.errors import ModelError
from planner import Array

TIED = 1e-4  # [m]; points that are this close to the lowest one touch as well


@dataclass(frozen=True)
class Sole:
    """Points of a leg; the floor acts below their mean."""

    geoms: Array  # geom that each belongs to, (n,)
    points: Array  # in that geom's frame, (n, 3) [m]
    depth: float  # distance from the points down to the floor [m]

    def touch(self, data: mujoco.MjData) -> Array:
        """Contact point of the foot, provided that it touches, shape (3,)."""
        placed = _place(data, self.geoms, self.points).mean(axis=0)
        return placed - (0.0, 0.0, self.depth)


def find_sole(model: mujoco.MjModel, data: mujoco.MjData, foot: Sequence[str]) -> Sole:
    """The sole of a foot.

    Args:
        model: Compiled robot.
        data: The robot as it stands.
        foot: Names of the foot's geoms.

    Raises:
        ModelError: If a geom has a shape that cannot be a foot.
    """
    owner: list[int] = []
    points: list[Array] = []
    depths: list[float] = []
    for name in foot:
        geom = model.geom(name).id
        core = _core(model, data, geom)
        owner += [geom] * len(core.points)
        points += list(core.points)
        depths += [core.radius] * len(core.points)
    geoms, local = np.array(owner), np.array(points)
    bottom = _place(data, geoms, local)[:, 2] - depths
    lowest = bottom <= bottom.min() + TIED
    depth = float(np.array(depths)[lowest].mean())
    return Sole(geoms[lowest], local[lowest], depth)


def _place(data: mujoco.MjData, geoms: Array, points: Array) -> Array:
    """Points in world coordinates, (n, 3)."""
    turned = np.einsum("nij,nj->ni", data.geom_xmat[geoms].reshape(-1, 3, 3), points)
    return data.geom_xpos[geoms] + turned


def _core(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Core:
    """The core of a geom; of a cylinder or ellipsoid its lowest points."""
    size, kind = model.geom_size[geom], model.geom_type[geom]
    down = -data.geom_xmat[geom].reshape(3, 3)[2]  # in the geom's frame
    if kind == Geom.mjGEOM_CYLINDER:
        return Core(_rims(size, down))
    if kind == Geom.mjGEOM_ELLIPSOID:
        return Core((size**2 * down / np.linalg.norm(size * down))[None])
    if (core := core_of(model, geom)) is not None:
        return core
    shape = Geom(kind).name.removeprefix("mjGEOM_").lower()
    raise ModelError(
        f"foot {model.geom(geom).name!r} is a {shape}: give it a sphere, a capsule, a "
        "box, a cylinder, an ellipsoid or a mesh to stand on"
    )


def _rims(size: Array, down: Array) -> Array:
    """Lowest points of a cylinder's two ends; their middles where it stands upright."""
    across = np.append(down[:2], 0.0)
    length = float(np.linalg.norm(across))
    return ends(size) + across * (size[0] / length if length > 1e-6 else 0.0)
