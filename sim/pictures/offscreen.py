"""Pictures of a walk, drawn off-screen with the driver that MUJOCO_GL names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import mujoco
import numpy as np
import shapely
from PIL import Image, ImageDraw

from models.description import root_body
from planner import Array
from sim import palette
from sim.palette import Colour
from sim.pictures.camera import HEIGHT, WIDTH, Camera
from sim.pictures.drawing import Drawing, Mark
from sim.pictures.ghost import Ghost, body_corners, ghost_of
from sim.pictures.panel import text
from sim.pictures.scene import SUN, Look, build, has_endless_floor, mesh_name
from sim.runs.run import Run

SUN_DISTANCE = 5.0  # [reach of the robot]
RADIUS = 9  # of the disc under the number of a leg [pixels]
OVERSAMPLING = 4  # of that disc when drawn, for smooth edges
RIM, ARROW = 2, 0.16  # width of the outline [pixels], size of the arrow [body's width]
SPARE_GEOMS = 1000  # beyond those of the model, for what MuJoCo adds


class OffscreenRenderer:
    """Draws one walk; holds a GL context until it is closed."""

    def __init__(
        self, walk: Run, marks: Sequence[Mark], camera: Camera, look: Look
    ) -> None:
        self._walk, self._camera = walk, camera
        self._model = build(walk, marks, look)
        self._first_face = self._model.mesh_faceadr.copy()
        pieces = [piece for mark in marks for piece in mark.pieces]
        self._pieces = [
            (self._model.mesh(mesh_name(name)).id, piece) for name, piece in pieces
        ]
        self._drawn = {self._model.geom(mesh_name(name)).id for name, _ in pieces}
        self._data = mujoco.MjData(self._model)
        self._numbers = LegNumbers(walk, self._model)
        self._body = BodyLines(walk, self._model)
        self._ghost = Ghost(walk, self._model, ghost_of(walk), meshes=True)
        self._view = mujoco.MjvCamera()
        self._options = mujoco.MjvOption()
        self._context = mujoco.GLContext(WIDTH, HEIGHT)
        self._context.make_current()
        self._scene = mujoco.MjvScene(self._model, self._model.ngeom + SPARE_GEOMS)
        flags, flag = self._scene.flags, mujoco.mjtRndFlag
        flags[flag.mjRND_SHADOW], flags[flag.mjRND_REFLECTION] = look.shadows, False
        # Half the time of a picture goes into the sky behind the floor.
        sky = camera.sees_sky or not has_endless_floor(self._model)
        flags[flag.mjRND_SKYBOX] = sky
        font = mujoco.mjtFontScale.mjFONTSCALE_100
        self._brush = mujoco.MjrContext(self._model, font)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._brush)

    def close(self) -> None:
        """Give the context back."""
        self._brush.free()
        self._context.free()

    def picture(self, frame: int, row: int) -> Array:
        """Draw the state of a row as seen in a frame, (HEIGHT, WIDTH, 3), bytes."""
        self._data.qpos[:] = self._walk.qpos[row]
        self._look_from(frame)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        for mesh, drawing in self._pieces:
            self._show(mesh, drawing, frame)
        all_geoms, scene = mujoco.mjtCatBit.mjCAT_ALL, self._scene
        shown = self._options, None, self._view, all_geoms, scene
        mujoco.mjv_updateScene(self._model, self._data, *shown)
        # Drawings lie closer to the floor than the depth of shadows can resolve.
        for geom in scene.geoms[: scene.ngeom]:
            if geom.objtype == mujoco.mjtObj.mjOBJ_GEOM and geom.objid in self._drawn:
                geom.category = mujoco.mjtCatBit.mjCAT_DECOR
        scene.ngeom += len(self._ghost.at(row, scene.geoms[scene.ngeom :]))
        frame_area = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
        picture = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        mujoco.mjr_render(frame_area, scene, self._brush)
        mujoco.mjr_readPixels(picture, None, frame_area, self._brush)
        picture = picture[::-1].copy()  # OpenGL counts rows from below
        self._body.write(picture, self._data, partial(self._camera.pixels, frame))
        places = self._numbers.places(self._data)
        self._numbers.write(picture, self._camera.pixels(frame, places))
        return picture

    def _look_from(self, frame: int) -> None:
        self._view.lookat[:] = self._camera.target[frame]
        self._view.azimuth = self._camera.azimuth[frame]
        self._view.elevation = self._camera.elevation
        self._view.distance = self._camera.distance
        # Shadows fall only around a light's position, even if its rays are parallel.
        away = SUN_DISTANCE * self._walk.reach
        self._model.light_pos[0] = self._camera.target[frame] - away * SUN

    def _show(self, mesh: int, drawing: Drawing, frame: int) -> None:
        """Pass only the triangles that are visible in this frame to the driver."""
        model = self._model
        first, count = drawing.visible(frame)
        first += self._first_face[mesh]
        if (model.mesh_faceadr[mesh], model.mesh_facenum[mesh]) != (first, count):
            model.mesh_faceadr[mesh], model.mesh_facenum[mesh] = first, count
            mujoco.mjr_uploadMesh(model, self._brush, mesh)


class BodyLines:
    """Draws the outline of the body, and an arrow on it that points to its front."""

    def __init__(self, walk: Run, model: mujoco.MjModel) -> None:
        self._root = root_body(model, walk.model_file)
        self._corners = body_corners(model, self._root)
        low, high = self._corners.min(axis=0), self._corners.max(axis=0)
        size = ARROW * (high - low)[:2].min()
        tip = np.array([high[0] - size, (low + high)[1] / 2, high[2]])
        self._arrow = tip + size * np.array(
            [(0, 0, 0), (-1.5, 0.8, 0), (-1.5, -0.8, 0)]
        )

    def write(
        self, picture: Array, data: mujoco.MjData, pixels: Callable[[Array], Array]
    ) -> None:
        """Draw on a picture of a state, in place."""
        place, turn = data.xpos[self._root], data.xmat[self._root].reshape(3, 3)
        corners = pixels(place + self._corners @ turn.T)
        rim = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(corners)))
        arrow = pixels(place + self._arrow @ turn.T)
        image = Image.fromarray(picture)
        draw = ImageDraw.Draw(image)
        draw.line(rim.ravel().tolist(), palette.FAINT, RIM, "curve")
        draw.polygon(arrow.ravel().tolist(), palette.TEXT)
        picture[:] = np.asarray(image)


class LegNumbers:
    """Writes the number of each leg at its foot."""

    def __init__(self, walk: Run, model: mujoco.MjModel) -> None:
        legs = sorted(walk.card.legs)
        self._feet = [model.geom(walk.card.legs[leg].foot[0]).id for leg in legs]
        owners = zip(legs, walk.group_of_foot, strict=True)
        self._discs = [_disc(str(leg), palette.group(owner)) for leg, owner in owners]

    def places(self, data: mujoco.MjData) -> Array:
        """Where the numbers belong, shape (legs, 3) [m]."""
        return data.geom_xpos[self._feet]

    def write(self, picture: Array, pixels: Array) -> None:
        """Write on a picture at pixels, (legs, 2), but not over its edge, in place."""
        for disc, (x, y) in zip(self._discs, np.round(pixels).astype(int), strict=True):
            side, half = disc.shape[0], disc.shape[0] // 2
            area = picture[max(y - half, 0) :, max(x - half, 0) :][:side, :side]
            if y < half or x < half or area.shape[:2] != (side, side):
                continue
            share = disc[..., 3:] / 255
            area[:] = np.round(share * disc[..., :3] + (1 - share) * area)


def _disc(number: str, colour: Colour) -> Array:
    """A number on a disc, shape (side, side, 4), bytes, the last one its opacity."""
    side = 2 * RADIUS + 3
    large = Image.new("RGBA", (side * OVERSAMPLING, side * OVERSAMPLING), (*colour, 0))
    draw, edge = ImageDraw.Draw(large), side * OVERSAMPLING - 1
    draw.ellipse((0, 0, edge, edge), (255, 255, 255, 255), colour, 2 * OVERSAMPLING)
    middle = side * OVERSAMPLING // 2
    text(draw, (middle, middle), number, 13 * OVERSAMPLING, "mm", palette.TEXT)
    return np.asarray(large.resize((side, side), Image.Resampling.LANCZOS))
