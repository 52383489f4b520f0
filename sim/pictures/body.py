"""What is written on pictures of a robot: its outline, its front, numbers of its legs.

The paths that its body hides are drawn once more, over it.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
import shapely
from PIL import Image, ImageDraw

from models.description import root_body
from planner import Array
from sim import palette
from sim.motion.poses import spaced_rows
from sim.palette import Colour
from sim.pictures.camera import HEIGHT, WIDTH
from sim.pictures.ghost import body_corners
from sim.pictures.legend import text
from sim.runs.run import Run

RIM, AHEAD = 2, 0.14  # width of lines [pixels]; of the word in front [body's width]
ROOM = np.array([24, 10])  # half that of the word [pixels]
SPACING = 0.006  # between points of the path below the body [reach of the robot]
RADIUS = 9  # of the disc under the number of a leg [pixels]
OVERSAMPLING = 4  # of that disc when drawn, for smooth edges


class BodyLines:
    """Draws what tells the body: its outline, its front, and the paths below it."""

    def __init__(self, walk: Run, model: mujoco.MjModel) -> None:
        self._root, height = root_body(model, walk.model_file), floor_height(walk.model)
        self._corners = body_corners(model, self._root)
        low, high = self._corners.min(axis=0), self._corners.max(axis=0)
        middle = (low[2] + high[2]) / 2
        edge = np.array([[high[0], y, middle] for y in (low[1], high[1])])
        label = edge.mean(axis=0) + (AHEAD * (high - low)[:2].min(), 0, 0)
        self._front = np.vstack([edge, label])
        self._rows = spaced_rows(walk.achieved[:, :2], SPACING * walk.reach)
        paths = walk.achieved[self._rows, :2], walk.nominal[:, :2], walk.center_of_mass
        self._paths = [np.insert(path, 2, height, axis=1) for path in paths]

    def write(
        self,
        picture: Array,
        data: mujoco.MjData,
        row: int,
        pixels: Callable[[Array], Array],
    ) -> None:
        """Draw on a picture of a state, in place."""
        place, turn = data.xpos[self._root], data.xmat[self._root].reshape(3, 3)
        corners, front = (
            pixels(place + points @ turn.T) for points in (self._corners, self._front)
        )
        rim = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(corners)))
        room = np.vstack([rim, front[2] + ROOM, front[2] - ROOM])
        (left, top), (right, bottom) = np.clip(
            (room.min(axis=0) - RIM, room.max(axis=0) + RIM + 1), 0, (WIDTH, HEIGHT)
        ).astype(int)
        area = picture[top:bottom, left:right]
        if not area.size:
            return
        rim, front = rim - (left, top), front - (left, top)
        walked, nominal, weight = self._paths
        walked = walked[: np.searchsorted(self._rows, row, side="right")]
        walked, nominal, (x, y) = (
            pixels(path) - (left, top) for path in (walked, nominal, weight[row])
        )
        image = Image.fromarray(area)
        inside, seen = Image.new("L", image.size), image.copy()
        ImageDraw.Draw(inside).polygon(rim.ravel().tolist(), 255)
        draw = ImageDraw.Draw(seen)
        draw.line(walked.ravel().tolist(), palette.ACHIEVED.colour, RIM)
        draw.line(nominal.ravel().tolist(), palette.NOMINAL.colour, RIM)
        draw.circle((x, y), 3 * RIM, palette.CENTRE_OF_MASS, palette.PAPER)
        image.paste(seen, mask=inside)
        draw = ImageDraw.Draw(image)
        draw.line(rim.ravel().tolist(), palette.FAINT, RIM, "curve")
        draw.line(front[:2].ravel().tolist(), palette.TEXT, 2 * RIM)
        x, y = front[2]
        draw.rounded_rectangle(
            (x - ROOM[0], y - ROOM[1], x + ROOM[0], y + ROOM[1]), ROOM[1], palette.PAPER
        )
        text(draw, (round(x), round(y)), "front", 14, "mm")
        area[:] = np.asarray(image)


class LegNumbers:
    """Writes the number of each leg at its foot, but not over a picture's edge."""

    def __init__(self, walk: Run, model: mujoco.MjModel) -> None:
        self._feet = [model.geom(walk.card.legs[n].foot[0]).id for n in walk.legs]
        owners = zip(walk.legs, walk.group_of_foot, strict=True)
        self._discs = [_disc(str(leg), palette.group(owner)) for leg, owner in owners]

    def write(
        self, picture: Array, data: mujoco.MjData, pixels: Callable[[Array], Array]
    ) -> None:
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


def floor_height(model: mujoco.MjModel) -> float:
    """Height of the tops of a world's floor [m]."""
    kinds = mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD
    for geom in np.flatnonzero(np.isin(model.geom_type, kinds)):
        field, low = model.geom_dataid[geom], float(model.geom_pos[geom, 2])
        return low + (float(model.hfield_size[field, 2]) if field >= 0 else 0.0)
    return 0.0
