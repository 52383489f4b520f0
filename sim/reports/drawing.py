"""Inline SVG drawn by matplotlib: curves and numbers, while the page adds the words.

Curves of whole walks would be solid combs: they have bands of their extremes, and show
where the page is zoomed. Text remains text, whose size the page sets.
"""

import io
import logging
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from planner import Array
from planner.support import shipped_tables
from sim import palette
from sim.runs.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WORDS = shipped_tables("sim.reports", "words.toml")
NOTES: Mapping[str, str] = WORDS["notes"]
MM = 1e3  # [mm/m]
PAGE_WIDTH = 7.2  # [in] of a drawing over the whole page
LEFT, RIGHT = 0.085, 0.985  # of the width, between which the axes lie
FEW = 8  # segments; fewer are divided into their phases
BAND, DETAIL = "band", "detail"  # classes of shapes, for the page's style and script
XLINK = "http://www.w3.org/1999/xlink"
IDS = re.compile(r' id="(?!m|p|C[0-9a-f]+_|DejaVu)[^"#]*"')  # others are referred to
HEAD = re.compile(r"<svg [^>]*viewBox=\"([^\"]*)\"[^>]*>")


@dataclass(frozen=True)
class Key:
    """An entry of the key under a drawing."""

    label: str
    colour: str
    dashes: tuple[float, ...] = ()  # of dash and gap, in widths of the line
    filled: bool = False

    @classmethod
    def of(cls, mark: palette.PathMark, label: str) -> "Key":
        """The entry of a path under a label of this drawing."""
        return cls(label, mark.colour.hex, mark.dashes)


@dataclass(frozen=True)
class Drawing:
    """A drawing as the page shows it."""

    svg: str  # without a size of its own
    heading: str  # what it shows, with the unit
    keys: list[Key] = field(default_factory=list)
    note: str = ""  # what a reader should know beside it
    # Left, top, right and bottom of the axes as shares of the drawing, and the data at
    # its left, right, bottom and top.
    box: tuple[float, ...] = ()


@contextmanager
def sheet(height: float, width: float = PAGE_WIDTH) -> "Iterator[tuple[Figure, Axes]]":
    """An empty figure, its sides [in] and its axes where the page expects them."""
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with rc_context(palette.style_of("pages")):
        figure = Figure(figsize=(width, height))
        FigureCanvasSVG(figure)
        low, high = 0.28 / height, 1 - 0.06 / height
        left = LEFT * PAGE_WIDTH / width
        axes = figure.add_axes((left, low, RIGHT - left, high - low))
        axes.tick_params(length=2.5, colors=palette.FAINT.hex)
        yield figure, axes


def finish(figure: "Figure", heading: str, keys: list[Key], note: str = "") -> Drawing:
    """Turn a figure into a drawing."""
    axes = figure.axes[0]
    axes.apply_aspect()
    place = axes.get_position()
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None}, transparent=True)
    sides = place.x0, 1 - place.y1, place.x1, 1 - place.y0
    box = (*sides, *axes.get_xlim(), *axes.get_ylim())
    # The svg element alone, scaled by the page.
    body = "<svg" + text.getvalue().partition("<svg")[2]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = re.sub(rf' id="({BAND}|{DETAIL})"', r' class="\1"', body)
    body = IDS.sub("", body)
    body = HEAD.sub(rf'<svg viewBox="\1" xmlns:xlink="{XLINK}">', body, count=1)
    return Drawing(re.sub(r"\n\s*", "\n", body), heading, keys, note, box)


def stretches(run: Run, few: bool | None = None) -> Array:
    """First rows of the segments, or of the phases of a walk with few segments."""
    segment = np.array([p.segment for p in run.phases])[run.phase]
    part = run.phase if (run.segments < FEW if few is None else few) else segment
    return np.flatnonzero(np.diff(part, prepend=-1))


def extremes_between(values: Array, starts: Array) -> tuple[Array, Array]:
    """Least and largest value of every stretch that begins in a row of `starts`."""
    return np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)


def add_band(axes: "Axes", edges: Array, low: Array, high: Array, colour: str) -> None:
    """Fill between the extremes of stretches, whose edges are one more than they."""
    from matplotlib.colors import to_rgb

    low, high = np.append(low, low[-1]), np.append(high, high[-1])
    fill = (*to_rgb(colour), 0.18)
    look: palette.Style = {"facecolor": fill, "edgecolor": colour, "linewidth": 0.7}
    axes.fill_between(edges, low, high, step="post", gid=BAND, **look)


def extremes(values: Array, bins: int = 500) -> Array:
    """Rows that keep the extremes of every bin of values, (T,) or (T, k)."""
    count = len(values)
    if count <= 2 * bins:
        return np.arange(count)
    columns = values.reshape(count, -1)
    kept = [np.array([0, count - 1])]
    for start, stop in pairwise(np.linspace(0, count, bins + 1).astype(int)):
        part = columns[start:stop]
        kept += [start + part.argmin(axis=0), start + part.argmax(axis=0)]
    return np.unique(np.concatenate(kept))
