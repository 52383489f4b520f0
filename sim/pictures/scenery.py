"""The scene of a film: the run's model with even light, a light floor, and ink on it.

The model is only drawn, never stepped; its states are those of the run.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from models import root_body
from sim.pictures import style
from sim.pictures.camera import FIELD_OF_VIEW
from sim.pictures.marks import Mark
from sim.pictures.story import FilmedWalk
from sim.pictures.style import HEIGHT, WIDTH, Look

AMBIENT, DIRECT = 0.74, 0.29  # light; on the floor they add up to 1: colours are true
SUN = np.array([-0.25, 0.35, -1.0])  # direction of the direct light
BODY_ALPHA = 0.25  # of the torso, so that the floor below is seen
LAYER = 0.0005  # thickness of a mark [reach of the robot]
SHEETS = 64  # of a layer; shapes that overlap lie on different ones, or are lit twice
SHADOW_MAP = 2048  # [texels]
EXTENT = 2.5  # [reach of the robot], over which the shadows' texels are spread
NEAR = 0.2  # [extent]; nothing is closer to the camera, and depth is the finer
PREFIX = "film: "  # of names, against those of the robot
GRID = f"{PREFIX}grid"


def build(walk: FilmedWalk, marks: Sequence[Mark], look: Look) -> mujoco.MjModel:
    """The model of a walk with its marks on the floor, one mesh each.

    Args:
        walk: Whose model.
        marks: What to draw on the floor, the lowest first.
        look: Quality of the pictures.
    """
    spec = mujoco.MjSpec.from_file(str(walk.model))
    _light(spec)
    floor = _lay_floor(spec)
    for layer, mark in enumerate(marks, start=1):
        sheet = mark.ink.shapes % SHEETS / SHEETS
        _draw(spec, mark, floor + LAYER * walk.reach * (layer + 0.9 * sheet))
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = WIDTH, HEIGHT
    visual.global_.fovy = FIELD_OF_VIEW
    visual.quality.offsamples, visual.quality.shadowsize = look.samples, SHADOW_MAP
    visual.map.znear = NEAR
    spec.stat.extent = EXTENT * walk.reach
    model = spec.compile()
    _see_through(model, root_body(model, walk.model))
    return model


def mesh_name(mark: Mark) -> str:
    """Name of the mesh that holds a mark's ink."""
    return PREFIX + mark.name


def _light(spec: mujoco.MjSpec) -> None:
    """Even light from everywhere, and one sun for the shadows."""
    for light in list(spec.lights):
        spec.delete(light)
    head = spec.visual.headlight
    head.ambient, head.diffuse, head.specular = [AMBIENT] * 3, [0.0] * 3, [0.0] * 3
    spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        dir=SUN,
        diffuse=[DIRECT] * 3,
        specular=[0.1] * 3,
        castshadow=True,
    )


def _lay_floor(spec: mujoco.MjSpec) -> float:
    """Give the plane under the robot a subtle grid of 0.1 m; its height [m]."""
    spec.add_texture(
        name=GRID,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=style.rgba(style.PAPER)[:3],
        rgb2=style.rgba(style.PAPER)[:3],
        markrgb=style.rgba(style.GRID)[:3],
        width=200,
        height=200,
    )
    grid = spec.add_material(name=GRID, texrepeat=(10, 10), texuniform=True, specular=0)
    grid.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = GRID
    planes = [g for g in spec.worldbody.geoms if g.type == mujoco.mjtGeom.mjGEOM_PLANE]
    for plane in planes:
        plane.material, plane.rgba = GRID, (1, 1, 1, 1)
    return float(planes[0].pos[2]) if planes else 0.0


def _draw(spec: mujoco.MjSpec, mark: Mark, height: np.ndarray) -> None:
    """One mesh for all the triangles that a mark will ever show, each at its height."""
    name = mesh_name(mark)
    corners = np.dstack([mark.ink.points, np.repeat(height[:, None], 3, axis=1)])
    # The compiler wants four points at least; this triangle is never shown.
    corners = np.concatenate([corners, corners[:1] + (1.0, 0.0, 0.0)])
    spec.add_mesh(
        name=name,
        uservert=corners.ravel(),
        userface=np.arange(3 * len(corners)),
        usernormal=np.tile((0.0, 0.0, 1.0), 3 * len(corners)),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    spec.add_material(name=name, rgba=style.rgba(mark.colour, mark.alpha), specular=0)
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        material=name,
        contype=0,
        conaffinity=0,
    )


def _see_through(model: mujoco.MjModel, body: int) -> None:
    for geom in np.flatnonzero(model.geom_bodyid == body):
        material = model.geom_matid[geom]
        if material >= 0:
            model.geom_rgba[geom] = model.mat_rgba[material]
        model.geom_rgba[geom, 3] *= BODY_ALPHA
