"""The scale bar of a film: a length on the floor at its own height in the picture."""

from __future__ import annotations

import numpy as np

from sim.pictures import style
from sim.pictures.camera import Camera
from sim.pictures.floor import cell
from sim.pictures.panel import EDGE, PAD, Panel, empty, length, text
from sim.pictures.style import WIDTH

HEIGHT = 50  # of the panel [pixels]
TICK = 5  # half the height of the bar's ends [pixels]


def scale_bar(view: Camera, reach: float, bottom: int) -> Panel:
    """The panel at the right, above the bar of numbers.

    Args:
        view: Where the film is taken from.
        reach: Of the robot [m]; the bar is one cell of the grid long.
        bottom: Lower edge of the panel [pixels].
    """
    metres, words = cell(reach), f"{1000 * cell(reach):g} mm on the floor here"
    bar = round(metres * _scale(view, bottom - HEIGHT // 3))
    width = max(bar, length(words)) + 2 * PAD
    still, draw = empty(width, HEIGHT)
    text(draw, (width - PAD, 6), words, anchor="ra", colour=style.FAINT)
    left, right, y = width - PAD - bar, width - PAD, HEIGHT - 15
    draw.line((left, y, right, y), style.TEXT, 3)
    for x in (left, right):
        draw.line((x, y - TICK, x, y + TICK), style.TEXT, 3)
    return Panel(WIDTH - EDGE - width, bottom - HEIGHT, still, lambda draw, row: None)


def _scale(view: Camera, y: int) -> float:
    """Pixels that one metre across the picture takes on the floor at a height."""
    tilt = np.radians(view.elevation)
    above = (style.HEIGHT / 2 - y) * view.pixel  # the middle, at a distance of one
    eye = view.eyes()[0]
    # How deep in the picture the ray through this height meets the floor.
    depth = -eye[2] / (np.sin(tilt) + above * np.cos(tilt))
    return float(1 / (view.pixel * depth))
