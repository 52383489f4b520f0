"""The scene of a film: the run's model in even light, with drawings on the floor.

The model is only drawn, never stepped; its states are those of the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from models.description import root_body
from sim import palette
from sim.pictures.camera import FIELD_OF_VIEW, HEIGHT, WIDTH
from sim.pictures.drawing import Mark
from sim.runs.run import Run

AMBIENT, DIRECT = 0.74, 0.29  # light; on the floor they add up to 1: colours are true
SUN = np.array([-0.25, 0.35, -1.0])  # direction of the direct light
BODY_ALPHA, PALER = 0.6, 0.5  # of the torso: the floor below and lines on it are seen
LAYER = 0.0005  # thickness of a mark [reach of the robot]
SHEETS = 64  # of a layer; shapes that overlap lie on different ones, or are lit twice
SHADOW_MAP = 2048  # [texels]
EXTENT = 2.5  # [reach of the robot], over which the shadows' texels are spread
NEAREST = 0.2  # [extent]; nothing is closer to the camera, and depth is the finer
PREFIX = "film: "  # of names, against those of the robot
FLOOR = f"{PREFIX}floor"


@dataclass(frozen=True, slots=True)
class Look:
    """The quality of a film's pictures."""

    shadows: bool
    samples: int  # of every pixel, against jagged edges
    slices: int  # of round shapes


LOOKS = {
    "draft": Look(shadows=False, samples=0, slices=14),
    "final": Look(shadows=True, samples=4, slices=28),
}


def build(walk: Run, marks: Sequence[Mark], look: Look) -> mujoco.MjModel:
    """The model of a walk with its marks on the floor, one mesh each."""
    spec = mujoco.MjSpec.from_file(str(walk.model_file))
    _light(spec)
    floor = _lay_floor(spec)
    for layer, mark in enumerate(marks, start=1):
        _draw(spec, mark, floor + LAYER * walk.reach * layer, LAYER * walk.reach)
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = WIDTH, HEIGHT
    visual.global_.fovy = FIELD_OF_VIEW
    visual.quality.offsamples, visual.quality.shadowsize = look.samples, SHADOW_MAP
    visual.quality.numslices, visual.quality.numstacks = look.slices, look.slices // 2
    visual.map.znear = NEAREST
    spec.stat.extent = EXTENT * walk.reach
    model = spec.compile()
    for geom in np.flatnonzero(model.geom_bodyid == root_body(model, walk.model_file)):
        if (material := model.geom_matid[geom]) >= 0:
            model.geom_rgba[geom] = model.mat_rgba[material]
        model.geom_rgba[geom, :3] += PALER * (1 - model.geom_rgba[geom, :3])
        model.geom_rgba[geom, 3] *= BODY_ALPHA
    return model


def has_endless_floor(model: mujoco.MjModel) -> bool:
    """Whether some plane of the world has no edges behind which there is sky."""
    planes = model.geom_size[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE]
    return bool((planes[:, :2] == 0).all(axis=1).any())


def mesh_name(piece: str) -> str:
    """Name of the mesh that holds a piece of a mark's drawing."""
    return PREFIX + piece


def _light(spec: mujoco.MjSpec) -> None:
    """Even light from everywhere, and one sun for the shadows."""
    for light in list(spec.lights):
        spec.delete(light)
    head = spec.visual.headlight
    head.ambient, head.diffuse, head.specular = [AMBIENT] * 3, [0.0] * 3, [0.0] * 3
    kind, diffuse = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, [DIRECT] * 3
    sun = {"dir": SUN, "diffuse": diffuse, "specular": [0.1] * 3, "castshadow": True}
    spec.worldbody.add_light(type=kind, **sun)


def _lay_floor(spec: mujoco.MjSpec) -> float:
    """Make the floor plain, with no texture; height of its tops [m]."""
    spec.add_material(name=FLOOR, specular=0)
    kinds = mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD
    floors = [geom for geom in spec.worldbody.geoms if geom.type in kinds]
    for geom in floors:
        geom.material, geom.rgba = FLOOR, palette.PAPER.rgba()
    if not floors:
        return 0.0
    field = spec.hfield(floors[0].hfieldname) if floors[0].hfieldname else None
    return float(floors[0].pos[2] + (0.0 if field is None else field.size[2]))


def _draw(spec: mujoco.MjSpec, mark: Mark, height: float, thickness: float) -> None:
    """A mesh for each piece of a mark, with all the triangles it will ever show."""
    material, rgba = mesh_name(mark.name), mark.colour.rgba(mark.alpha)
    spec.add_material(name=material, rgba=rgba, specular=0)
    for piece, drawing in mark.pieces:
        name, sheet = mesh_name(piece), drawing.shapes % SHEETS / SHEETS
        z = height + 0.9 * sheet * thickness
        corners = np.dstack([drawing.points, np.repeat(z[:, None], 3, axis=1)])
        # The compiler wants four points at least; this triangle is never shown.
        corners = np.concatenate([corners, corners[:1] + (1.0, 0.0, 0.0)])
        spec.add_mesh(
            name=name,
            uservert=corners.ravel(),
            userface=np.arange(3 * len(corners)),
            usernormal=np.tile((0.0, 0.0, 1.0), 3 * len(corners)),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
        mesh = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": name}
        own = {**mesh, "material": material, "rgba": rgba}  # not the file's defaults
        spec.worldbody.add_geom(name=name, group=0, contype=0, conaffinity=0, **own)
