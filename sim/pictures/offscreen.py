"""Pictures of a walk, drawn off-screen with the driver that MUJOCO_GL names.

They show the run's model in even light, with drawings on the floor. The model is only
drawn, never stepped; its states are those of the run.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
import shapely
from PIL import Image, ImageDraw

from models.description import fixed_to, root_body
from planner import Array
from sim import palette
from sim.motion.poses import spaced_rows
from sim.palette import Colour
from sim.pictures.camera import FIELD_OF_VIEW, FILM, HEIGHT, WIDTH, Camera
from sim.pictures.drawing import Drawing, Mark
from sim.pictures.ghost import Ghost, body_corners, ghost_of
from sim.pictures.legend import NOSE, text
from sim.runs.run import Run
from sim.world.parts import forget_defaults
from sim.world.sensors import floor_in

SUN = np.array([-0.25, 0.35, -1.0])  # direction of the direct light
PALER = 0.5  # of the torso, through which the floor and lines on it are seen
LAYER = 0.0005  # thickness of a mark [reach of the robot]
SHEETS = 64  # of a layer; shapes that overlap lie on different ones, or are lit twice
DUSK = 4.0  # below the horizon [degrees], where the floor may end
PREFIX = "film: "  # of names, against those of the robot
FLOOR = f"{PREFIX}floor"
RIM, AHEAD = 2, 0.14  # width of lines [pixels]; of the word in front [body's width]
RADIUS = 9  # of the disc under the number of a leg [pixels]
OVERSAMPLING = 4  # of that disc when drawn, for smooth edges
Pixels = Callable[[Array], Array]  # where points are in a picture


@dataclass(frozen=True, slots=True)
class Look:
    """The quality of a film's pictures."""

    shadows: bool
    samples: int  # of every pixel, against jagged edges
    slices: int  # of round shapes
    ambient: float  # light from everywhere; the sun's adds up to 1: colours are true
    gloss: float  # of the robot in the sun
    body: float  # opacity of the torso


LOOKS = {name: Look(**look) for name, look in FILM["looks"].items()}


class OffscreenRenderer:
    """Draws one walk; holds a GL context until it is closed."""

    def __init__(
        self, walk: Run, marks: Sequence[Mark], camera: Camera, look: Look
    ) -> None:
        self._walk, self._camera = walk, camera
        self._model = model = build(walk, marks, look)
        self._first_face = model.mesh_faceadr.copy()
        pieces = [(PREFIX + name, d) for mark in marks for name, d in mark.pieces]
        self._pieces = [(model.mesh(name).id, drawing) for name, drawing in pieces]
        self._drawn = {model.geom(name).id for name, _ in pieces}
        self._data = mujoco.MjData(model)
        self._numbers, self._body = LegNumbers(walk, model), BodyLines(walk, model)
        self._ghost = Ghost(walk, model, ghost_of(walk), meshes=True)
        self._view = mujoco.MjvCamera()
        self._view.elevation, self._view.distance = camera.elevation, camera.distance
        self._options = mujoco.MjvOption()
        self._context = mujoco.GLContext(WIDTH, HEIGHT)
        self._context.make_current()
        self._scene = mujoco.MjvScene(model, model.ngeom + 1000)  # MuJoCo adds some
        flags, flag = self._scene.flags, mujoco.mjtRndFlag
        flags[flag.mjRND_SHADOW], flags[flag.mjRND_REFLECTION] = look.shadows, False
        # Half the time of a picture goes into the sky behind an endless floor.
        planes = model.geom_size[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE]
        endless = (planes[:, :2] == 0).all(axis=1).any()
        sees_sky = camera.elevation + FIELD_OF_VIEW / 2 > -DUSK
        flags[flag.mjRND_SKYBOX] = sees_sky or not endless
        self._brush = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._brush)

    def close(self) -> None:
        """Give the context back."""
        self._brush.free()
        self._context.free()

    def picture(self, frame: int, row: int) -> Array:
        """Draw the state of a row as seen in a frame, (HEIGHT, WIDTH, 3), bytes."""
        model, data, scene = self._model, self._data, self._scene
        self._view.lookat[:] = target = self._camera.target[frame]
        self._view.azimuth = self._camera.azimuth[frame]
        # Shadows fall only around a light's position, even if its rays are parallel.
        model.light_pos[0] = target - 5.0 * self._walk.reach * SUN
        data.qpos[:] = self._walk.qpos[row]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        for mesh, drawing in self._pieces:
            self._show(mesh, drawing, frame)
        shown = self._options, None, self._view, mujoco.mjtCatBit.mjCAT_ALL, scene
        mujoco.mjv_updateScene(model, data, *shown)
        # Drawings lie closer to the floor than the depth of shadows can resolve.
        for geom in scene.geoms[: scene.ngeom]:
            if geom.objtype == mujoco.mjtObj.mjOBJ_GEOM and geom.objid in self._drawn:
                geom.category = mujoco.mjtCatBit.mjCAT_DECOR
        scene.ngeom += len(self._ghost.at(row, scene.geoms[scene.ngeom :]))
        area = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
        picture = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        mujoco.mjr_render(area, scene, self._brush)
        mujoco.mjr_readPixels(picture, None, area, self._brush)
        picture = picture[::-1].copy()  # OpenGL counts rows from below
        pixels = partial(self._camera.pixels, frame)
        self._body.write(picture, data, row, pixels)
        self._numbers.write(picture, data, pixels)
        return picture

    def _show(self, mesh: int, drawing: Drawing, frame: int) -> None:
        """Pass only the triangles that are visible in this frame to the driver."""
        first, count = drawing.visible(frame)
        first += self._first_face[mesh]
        faces, numbers = self._model.mesh_faceadr, self._model.mesh_facenum
        if (faces[mesh], numbers[mesh]) != (first, count):
            faces[mesh], numbers[mesh] = first, count
            mujoco.mjr_uploadMesh(self._model, self._brush, mesh)


class BodyLines:
    """Draws what tells the body: its outline, its front, and the paths below it."""

    def __init__(self, walk: Run, model: mujoco.MjModel) -> None:
        self._root, height = root_body(model, walk.model_file), floor_height(walk)
        self._corners = body_corners(model, self._root)
        low, high = self._corners.min(axis=0), self._corners.max(axis=0)
        middle, ahead = (low[2] + high[2]) / 2, AHEAD * (high - low)[:2].min()
        front = ((0, low[1]), (0, high[1]), (ahead, (low[1] + high[1]) / 2))
        self._front = np.array([(high[0] + x, y, middle) for x, y in front])
        self._rows = spaced_rows(walk.achieved[:, :2], 0.006 * walk.reach)
        paths = walk.achieved[self._rows, :2], walk.nominal[:, :2], walk.center_of_mass
        self._ways = [np.insert(path, 2, height, axis=1) for path in paths]

    def write(
        self, picture: Array, data: mujoco.MjData, row: int, pixels: Pixels
    ) -> None:
        """Draw on a picture of a state, in place."""
        place, turn = data.xpos[self._root], data.xmat[self._root].reshape(3, 3)
        hull = shapely.MultiPoint(pixels(place + self._corners @ turn.T)).convex_hull
        *edge, (x, y) = map(tuple, pixels(place + self._front @ turn.T).tolist())
        walked, nominal, weight = self._ways
        walked = walked[: np.searchsorted(self._rows, row, side="right")]
        image = Image.fromarray(picture)
        draw = ImageDraw.Draw(image)
        for path, mark in ((walked, palette.ACHIEVED), (nominal, palette.NOMINAL)):
            points = pixels(path)
            hidden = shapely.contains_xy(hull, points)
            cuts = np.flatnonzero(np.diff(hidden)) + 1
            for part in np.split(points, cuts)[int(not hidden[:1].all()) :: 2]:
                draw.line(part.ravel().tolist(), mark.colour, RIM)
        spot = pixels(weight[row]).tolist()
        draw.circle(spot, 4 * RIM, palette.CENTRE_OF_MASS, palette.PAPER, RIM)
        draw.line(shapely.get_coordinates(hull).ravel().tolist(), palette.FAINT, RIM)
        draw.line(edge, palette.TEXT, 2 * RIM)
        draw.rounded_rectangle((x - 24, y - 10, x + 24, y + 10), 10, palette.PAPER)
        text(draw, (round(x), round(y)), "front", 14, "mm")
        picture[:] = np.asarray(image)


class LegNumbers:
    """Writes the number of each leg at its foot, but not over a picture's edge."""

    def __init__(self, walk: Run, model: mujoco.MjModel) -> None:
        self._feet = [model.geom(walk.card.legs[n].foot[0]).id for n in walk.legs]
        owners = zip(walk.legs, walk.group_of_foot, strict=True)
        self._discs = [_disc(str(leg), palette.group(owner)) for leg, owner in owners]

    def write(self, picture: Array, data: mujoco.MjData, pixels: Pixels) -> None:
        """Write on a picture of a state, in place."""
        places = np.round(pixels(data.geom_xpos[self._feet])).astype(int)
        for disc, (x, y) in zip(self._discs, places, strict=True):
            side, half = disc.shape[0], disc.shape[0] // 2
            area = picture[max(y - half, 0) :, max(x - half, 0) :][:side, :side]
            if y < half or x < half or area.shape[:2] != (side, side):
                continue
            share = disc[..., 3:] / 255
            area[:] = np.round(share * disc[..., :3] + (1 - share) * area)


def _disc(number: str, colour: Colour) -> Array:
    """A number on a disc, shape (side, side, 4), bytes, the last one its opacity."""
    side = 2 * RADIUS + 3
    whole = side * OVERSAMPLING
    large = Image.new("RGBA", (whole, whole), (*colour, 0))
    draw = ImageDraw.Draw(large)
    rim = (0, 0, whole - 1, whole - 1)
    draw.ellipse(rim, (255, 255, 255, 255), colour, 2 * OVERSAMPLING)
    text(draw, (whole // 2, whole // 2), number, 13 * OVERSAMPLING, "mm", palette.TEXT)
    return np.asarray(large.resize((side, side), Image.Resampling.LANCZOS))


def floor_height(walk: Run) -> float:
    """Height of the tops of a world's floor [m]."""
    floor = floor_in(walk.model, walk.card.feet[0])
    return float(walk.model.geom_pos[floor, 2]) + walk.scenario.bumps


def build(walk: Run, marks: Sequence[Mark], look: Look) -> mujoco.MjModel:
    """The model of a walk with its marks on the floor, one mesh each."""
    spec = mujoco.MjSpec.from_file(str(walk.model_file))
    forget_defaults(spec)  # marks are meshes, and have no scale of a file's
    spec.visual, spec.stat = mujoco.MjSpec().visual, mujoco.MjSpec().stat
    _light(spec, look)
    _lay_floor(spec)
    floor = floor_height(walk)
    for layer, mark in enumerate(marks, start=1):
        _draw(spec, mark, floor + LAYER * walk.reach * layer, LAYER * walk.reach)
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = WIDTH, HEIGHT
    visual.global_.fovy = FIELD_OF_VIEW
    visual.quality.offsamples, visual.quality.shadowsize = look.samples, 2048
    visual.quality.numslices, visual.quality.numstacks = look.slices, look.slices // 2
    visual.map.znear = 0.2  # nothing is closer to the camera; depth is the finer
    spec.stat.extent = 2.5 * walk.reach  # over which the shadows' texels are spread
    model = spec.compile()
    plate = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, NOSE)
    torso = fixed_to(model, root_body(model, walk.model_file))
    for geom in torso[torso != plate]:
        if (material := model.geom_matid[geom]) >= 0:
            model.geom_rgba[geom] = model.mat_rgba[material]
        model.geom_rgba[geom, :3] += PALER * (1 - model.geom_rgba[geom, :3])
        model.geom_rgba[geom, 3] *= look.body
    return model


def _light(spec: mujoco.MjSpec, look: Look) -> None:
    """Even light from everywhere, and one sun for the shadows."""
    for light in list(spec.lights):
        spec.delete(light)
    head = spec.visual.headlight
    dark, level = [0.0] * 3, -SUN[2] / np.linalg.norm(SUN)  # of the sun on the floor
    head.ambient, head.diffuse, head.specular = [look.ambient] * 3, dark, dark
    direct = [(1 - look.ambient) / level] * 3
    sun = {"dir": SUN, "diffuse": direct, "specular": [look.gloss] * 3}
    sun["type"] = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    spec.worldbody.add_light(castshadow=True, **sun)


def _lay_floor(spec: mujoco.MjSpec) -> None:
    """Make the floor plain, with no texture."""
    spec.add_material(name=FLOOR, specular=0)
    kinds = mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD
    for geom in spec.geoms:
        if geom.type in kinds:
            geom.material, geom.rgba = FLOOR, palette.PAPER.rgba()


def _draw(spec: mujoco.MjSpec, mark: Mark, height: float, thickness: float) -> None:
    """A mesh for each piece of a mark, with all the triangles it will ever show."""
    material, rgba = PREFIX + mark.name, mark.colour.rgba(mark.alpha)
    spec.add_material(name=material, rgba=rgba, specular=0)
    for piece, drawing in mark.pieces:
        name, sheet = PREFIX + piece, drawing.shapes % SHEETS / SHEETS
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
