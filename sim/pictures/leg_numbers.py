"""Numbers drawn on the legs of the robot."""

from __future__ import annotations

import mujoco
import numpy as np
from PIL import Image, ImageDraw

from planner import Array
from sim.pictures import style
from sim.pictures.filmed_walk import FilmedWalk
from sim.pictures.panel import text
from sim.pictures.style import Colour

RADIUS = 9  # of the disc under a number [pixels]
FINE = 4  # times larger when drawn, for smooth edges


class LegNumbers:
    """Writes the number of each leg halfway between its lift joint and its foot."""

    def __init__(self, walk: FilmedWalk, model: mujoco.MjModel) -> None:
        legs = sorted(walk.card.legs)
        self._joints = [model.joint(walk.card.legs[leg].lift).id for leg in legs]
        self._feet = [model.geom(walk.card.legs[leg].foot[0]).id for leg in legs]
        owners = zip(legs, walk.group_of_foot, strict=True)
        self._discs = [_disc(str(leg), style.group(owner)) for leg, owner in owners]

    def places(self, data: mujoco.MjData) -> Array:
        """Where the numbers belong, shape (legs, 3) [m]."""
        return (data.xanchor[self._joints] + data.geom_xpos[self._feet]) / 2

    def write(self, picture: Array, pixels: Array) -> None:
        """Write the numbers on a picture, in place.

        Args:
            picture: Shape (height, width, 3), bytes.
            pixels: Where, shape (legs, 2); numbers over the edge are left out.
        """
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
    large = Image.new("RGBA", (side * FINE, side * FINE), (*colour, 0))
    draw, edge = ImageDraw.Draw(large), side * FINE - 1
    draw.ellipse((0, 0, edge, edge), (255, 255, 255, 255), colour, 2 * FINE)
    middle = side * FINE // 2
    text(draw, (middle, middle), number, 13 * FINE, "mm", style.TEXT)
    return np.asarray(large.resize((side, side), Image.Resampling.LANCZOS))
