"""Inline SVG drawn by matplotlib: curves and numbers, while the page adds the words.

Text remains text and has a class of its own, so that the page sets its size. On a
telephone, where the drawing is smaller, the text is larger.
"""

from __future__ import annotations

import io
import logging
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 7.2  # [in] of a drawing over the whole page
LEFT, RIGHT = 0.085, 0.985  # of the width, between which the axes lie
LOOK: Mapping[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "stratawalk",  # the same drawing gives the same bytes
    "font.size": 8,
    "font.family": "sans-serif",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e4e7eb",
    "grid.linewidth": 0.5,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.1,
    "lines.solid_joinstyle": "round",
    "axes.formatter.useoffset": False,
}
IDS = re.compile(r' id="(?!m|p|DejaVu)[^"#]*"')  # others are referred to
HEAD = re.compile(r"<svg [^>]*viewBox=\"([^\"]*)\"[^>]*>")


@dataclass(frozen=True)
class Key:
    """An entry of the key under a drawing."""

    label: str
    colour: str
    dashed: bool = False
    filled: bool = False


@dataclass
class Drawing:
    """A drawing as the page shows it.

    Attributes:
        svg: The drawing, without a size of its own.
        heading: What it shows, with the unit.
        keys: Meaning of its colours.
        note: What a reader should know beside it.
        box: Left, top, right and bottom of the axes as shares of the drawing, and the
            data at its left, right, bottom and top.
    """

    svg: str
    heading: str
    keys: list[Key] = field(default_factory=list)
    note: str = ""
    box: tuple[float, ...] = ()


@contextmanager
def sheet(height: float, width: float = WIDTH) -> Iterator[tuple[Figure, Axes]]:
    """An empty figure with one pair of axes, whose sides lie where the page expects.

    Args:
        height: [in].
        width: [in].
    """
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with rc_context(dict(LOOK)):
        figure = Figure(figsize=(width, height))
        FigureCanvasSVG(figure)
        low, high = 0.28 / height, 1 - 0.06 / height
        left = LEFT * WIDTH / width
        axes = figure.add_axes((left, low, RIGHT - left, high - low))
        axes.tick_params(length=2.5, colors="#4a5261")
        yield figure, axes


def finish(figure: Figure, heading: str, keys: list[Key], note: str = "") -> Drawing:
    """Turn a figure into a drawing."""
    axes = figure.axes[0]
    axes.apply_aspect()
    place = axes.get_position()
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None}, transparent=True)
    box = (
        place.x0, 1 - place.y1, place.x1, 1 - place.y0,
        *axes.get_xlim(), *axes.get_ylim(),
    )  # fmt: skip
    return Drawing(_inline(text.getvalue(), heading), heading, keys, note, box)


def _inline(svg: str, heading: str) -> str:
    """The svg element alone, scaled by the page."""
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = IDS.sub("", body)
    label = f'role="img" aria-label="{heading}"'
    body = HEAD.sub(rf'<svg viewBox="\1" xmlns:xlink="{XLINK}" {label}>', body, count=1)
    return re.sub(r"\n\s*", "\n", body)


XLINK = "http://www.w3.org/1999/xlink"
