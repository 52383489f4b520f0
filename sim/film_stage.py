"""The set of a film: the run's model with calm light, a light floor, and ink on it.

Draws single pictures off-screen with the driver that MUJOCO_GL names. Never steps:
every picture is a saved state.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import TracebackType
from typing import Self

import mujoco
import numpy as np

from models.robot import root_body
from sim import film_style as style
from sim.film_camera import FIELD_OF_VIEW, Camera
from sim.film_marks import Mark
from sim.film_style import HEIGHT, WIDTH, Look
from sim.film_walk import Walk

Array = np.ndarray

AMBIENT, DIRECT = 0.62, 0.42  # light; on the floor they add up to 1: colours are true
SUN = (-0.25, 0.35, -1.0)  # direction of the direct light
BODY_ALPHA = 0.25  # of the torso, so that the floor below is seen
LAYER = 0.0013  # between marks [reach of the robot]
SHADOW_MAP = 2048  # [texels]
EXTENT = 2.5  # [reach of the robot], over which the shadows' texels are spread
NEAR = 0.2  # [extent]; nothing is closer to the camera, and depth is the finer
PREFIX = "film: "  # of names, against those of the robot
GRID = f"{PREFIX}grid"
STEP, STEPS = 4e-6, 64  # [m]; where shapes overlap in one plane the sun counts twice
ROOM = 1000  # geoms beyond those of the model, for what MuJoCo adds


class Stage:
    """Draws one walk; holds a GL context until it is closed."""

    def __init__(
        self, walk: Walk, marks: Sequence[Mark], camera: Camera, look: Look
    ) -> None:
        self._walk, self._marks, self._camera = walk, marks, camera
        self._model = _build(walk, marks, look)
        self._first_face = self._model.mesh_faceadr.copy()
        self._data = mujoco.MjData(self._model)
        self._view = mujoco.MjvCamera()
        self._options = mujoco.MjvOption()
        self._context = mujoco.GLContext(WIDTH, HEIGHT)
        self._context.make_current()
        self._scene = mujoco.MjvScene(self._model, maxgeom=self._model.ngeom + ROOM)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = look.shadows
        self._scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self._brush = mujoco.MjrContext(
            self._model, mujoco.mjtFontScale.mjFONTSCALE_100
        )
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._brush)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._brush.free()
        self._context.free()

    def picture(self, frame: int, row: int) -> Array:
        """Draw the state of a row.

        Args:
            frame: Decides the view, and which ink is visible.
            row: Of the trajectory.

        Returns:
            Shape (HEIGHT, WIDTH, 3), bytes.
        """
        self._data.qpos[:] = self._walk.qpos[row]
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        self._look_from(frame)
        for mark in self._marks:
            self._show(mark, frame)
        mujoco.mjv_updateScene(
            self._model,
            self._data,
            self._options,
            None,
            self._view,
            mujoco.mjtCatBit.mjCAT_ALL,
            self._scene,
        )
        frame_area = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
        picture = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        mujoco.mjr_render(frame_area, self._scene, self._brush)
        mujoco.mjr_readPixels(picture, None, frame_area, self._brush)
        return picture[::-1]  # OpenGL counts rows from below

    def _look_from(self, frame: int) -> None:
        self._view.lookat[:] = self._camera.target[frame]
        self._view.azimuth = self._camera.azimuth[frame]
        self._view.elevation = self._camera.elevation
        self._view.distance = self._camera.distance

    def _show(self, mark: Mark, frame: int) -> None:
        """Let the driver see only the triangles that are visible in this frame."""
        mesh = self._model.mesh(PREFIX + mark.name)
        first, count = mark.ink.visible(frame)
        begin = self._first_face[mesh.id] + first
        if (self._model.mesh_faceadr[mesh.id], self._model.mesh_facenum[mesh.id]) == (
            begin,
            count,
        ):
            return
        self._model.mesh_faceadr[mesh.id], self._model.mesh_facenum[mesh.id] = (
            begin,
            count,
        )
        mujoco.mjr_uploadMesh(self._model, self._brush, mesh.id)


def _build(walk: Walk, marks: Sequence[Mark], look: Look) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_file(str(walk.model))
    _light(spec)
    floor = _lay_floor(spec)
    for layer, mark in enumerate(marks, start=1):
        _draw(spec, mark, floor + layer * LAYER * walk.reach)
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = WIDTH, HEIGHT
    visual.global_.fovy = FIELD_OF_VIEW
    visual.quality.offsamples, visual.quality.shadowsize = look.samples, SHADOW_MAP
    visual.map.znear = NEAR
    spec.stat.extent = EXTENT * walk.reach
    model = spec.compile()
    _see_through(model, root_body(model, walk.model))
    return model


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


def _draw(spec: mujoco.MjSpec, mark: Mark, height: float) -> None:
    """One mesh for all the triangles that a mark will ever show."""
    name = PREFIX + mark.name
    lift = height + STEP * (mark.ink.shapes % STEPS)
    corners = np.dstack([mark.ink.points, np.repeat(lift[:, None], 3, axis=1)])
    spec.add_mesh(
        name=name,
        uservert=corners.ravel(),
        userface=np.arange(3 * len(mark.ink)),
        usernormal=np.tile((0.0, 0.0, 1.0), 3 * len(mark.ink)),
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
