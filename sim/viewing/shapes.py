"""Geoms of MuJoCo as triangles."""

from __future__ import annotations

import mujoco
import numpy as np

from planner import Array

Mesh = tuple[Array, Array]  # corners (N, 3) [m] and faces (M, 3)
KIND = mujoco.mjtGeom
ROUND = 20  # sides of what is round


def mesh_of(model: mujoco.MjModel, geom: int) -> Mesh | None:
    """The surface of a geom in its own frame; None of planes and height fields.

    Args:
        model: Whose geom.
        geom: Its index.
    """
    import trimesh

    size, kind = model.geom_size[geom], model.geom_type[geom]
    if kind == KIND.mjGEOM_MESH:
        return _of_file(model, int(model.geom_dataid[geom]))
    make = trimesh.creation
    if kind == KIND.mjGEOM_BOX:
        shape = make.box(extents=2 * size)
    elif kind == KIND.mjGEOM_CYLINDER:
        shape = make.cylinder(radius=size[0], height=2 * size[1], sections=ROUND)
    elif kind == KIND.mjGEOM_CAPSULE:
        ends = [[0, 0, -size[1]], [0, 0, size[1]]]
        shape = make.cylinder(radius=size[0], segment=ends, sections=ROUND)
        for end in ends:
            ball = make.icosphere(subdivisions=2, radius=size[0])
            ball.apply_translation(end)
            shape = trimesh.util.concatenate([shape, ball])
    elif kind in (KIND.mjGEOM_SPHERE, KIND.mjGEOM_ELLIPSOID):
        shape = make.icosphere(subdivisions=2, radius=1.0)
        shape.apply_scale(size if kind == KIND.mjGEOM_ELLIPSOID else size[0])
    else:
        return None
    return np.asarray(shape.vertices), np.asarray(shape.faces)


def _of_file(model: mujoco.MjModel, mesh: int) -> Mesh:
    corner, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
    corners = model.mesh_vert[corner : corner + model.mesh_vertnum[mesh]]
    return corners, model.mesh_face[face : face + model.mesh_facenum[mesh]]
