"""Where feet touch the floor: the lowest points of their geoms as the robot stands.

Round geoms touch below a point that goes with the leg, however it turns; edges and
corners touch with points of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from models.errors import ModelError
from planner import Array

Geom = mujoco.mjtGeom
TIED = 1e-4  # [m]; points as low as the lowest but for this touch with it


@dataclass(frozen=True)
class Sole:
    """Points of a leg under whose middle the floor pushes."""

    geoms: Array  # geom that each belongs to, (n,)
    points: Array  # in that geom's frame, (n, 3) [m]
    depth: float  # of the floor below them [m]

    def touch(self, data: mujoco.MjData) -> Array:
        """Where the foot touches, if it does, shape (3,)."""
        placed = _place(data, self.geoms, self.points).mean(axis=0)
        return np.asarray(placed - (0.0, 0.0, self.depth))


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
        cores, depth = _cores(model, data, geom)
        owner += [geom] * len(cores)
        points += list(cores)
        depths += [depth] * len(cores)
    geoms, local = np.array(owner), np.array(points)
    bottom = _place(data, geoms, local)[:, 2] - depths
    lowest = bottom < bottom.min() + TIED
    depth = float(np.array(depths)[lowest].mean())
    return Sole(geoms[lowest], local[lowest], depth)


def _place(data: mujoco.MjData, geoms: Array, points: Array) -> Array:
    """Points in world coordinates, (n, 3)."""
    turned = np.einsum("nij,nj->ni", data.geom_xmat[geoms].reshape(-1, 3, 3), points)
    return np.asarray(data.geom_xpos[geoms] + turned)


def _cores(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int
) -> tuple[Array, float]:
    """Points in the geom's frame, and the radius around them that belongs to it."""
    size, kind = model.geom_size[geom], model.geom_type[geom]
    down = -data.geom_xmat[geom].reshape(3, 3)[2]  # in the geom's frame
    if kind == Geom.mjGEOM_SPHERE:
        return np.zeros((1, 3)), float(size[0])
    if kind == Geom.mjGEOM_CAPSULE:
        return np.array([[0, 0, -size[1]], [0, 0, size[1]]]), float(size[0])
    if kind == Geom.mjGEOM_BOX:
        return np.array(list(product((-1, 1), repeat=3))) * size, 0.0
    if kind == Geom.mjGEOM_CYLINDER:
        return _rims(size, down), 0.0
    if kind == Geom.mjGEOM_ELLIPSOID:
        return (size**2 * down / np.linalg.norm(size * down))[None], 0.0
    if kind == Geom.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        return model.mesh_vert[first : first + count].astype(float), 0.0
    shape = Geom(kind).name.removeprefix("mjGEOM_").lower()
    raise ModelError(
        f"foot {model.geom(geom).name!r} is a {shape}: give it a sphere, a capsule, a "
        "box, a cylinder, an ellipsoid or a mesh to stand on"
    )


def _rims(size: Array, down: Array) -> Array:
    """Lowest points of a cylinder's two ends; their middles where it stands upright."""
    across = np.append(down[:2], 0.0)
    length = float(np.linalg.norm(across))
    rim = across * (size[0] / length if length > 1e-6 else 0.0)
    return np.array([rim - (0, 0, size[1]), rim + (0, 0, size[1])])
