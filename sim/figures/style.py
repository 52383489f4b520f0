"""The style of figures: sizes for print, and drawing that several of them share."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner import Array
from sim import palette
from sim.palette import ACHIEVED, GROUPS, PREDICTED, Style
from sim.reports.drawing import MM as MM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from sim.figures.physics import Walked


NOMINAL = palette.NOMINAL.colour.hex
IDEAL = PREDICTED["ideal"].colour.hex
QUASI_STATIC = PREDICTED["quasi_static"].colour.hex
PHYSICS = ACHIEVED.colour.hex
INK = palette.TEXT.hex  # also the centre of mass
TRIPODS: Mapping[str, str] = {"1": GROUPS[0].hex, "2": GROUPS[1].hex}
STRATA: Mapping[str, str] = {"12": INK, **TRIPODS}  # of what happens on each
LEGS: Mapping[str, tuple[int, ...]] = {"1": (1, 4, 5), "2": (2, 3, 6)}
COLOURS: Mapping[str, str] = {  # by what they mean, for `sheets.toml`
    **{"nominal": NOMINAL, "ink": INK, "wall": palette.OBSTACLE.hex},
    **{"body": palette.OUTLINE.tint(0.35).hex, "absent": palette.OUTLINE.hex},
    **{f"tripod {name}": colour for name, colour in TRIPODS.items()},
    **{f"group {i}": colour.hex for i, colour in enumerate(GROUPS, start=1)},
}
PATHS: Mapping[str, Style] = {  # of a walk, the broad ones below
    "achieved": ACHIEVED.line(color=ACHIEVED.colour.tint(0.45).hex, label="physics"),
    "ideal": PREDICTED["ideal"].line(linewidth=0.6, label="predicted, ideal"),
    "quasi_static": PREDICTED["quasi_static"].line(label="predicted, quasi-static"),
}

STYLE = palette.style_of("figures")


def sheet_of(
    mosaic: str, height: float, options: Style | None = None
) -> "tuple[Figure, dict[str, Axes]]":
    """An empty figure of the page's width, its panels by their letters."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, height), layout="constrained")  # [in]
    FigureCanvasAgg(figure)
    return figure, figure.subplot_mosaic(mosaic, **(options or {}))


def plain_decades(*axes: "Axis", subs: tuple[int, ...] = (1, 2, 5)) -> None:
    """Logarithmic axes with 1, 2 and 5 of every decade written out, or those given."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis in axes:
        axis.set_major_locator(LogLocator(subs=subs))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def draw_walk(axes: "Axes", walked: "Walked", scale: float = MM) -> None:
    """Physics as a broad line, both predictions on it, and the nominal path on top."""
    for name, style in PATHS.items():
        axes.plot(*(scale * walked.pose[name][:, :2].T), **style)
    line: Style = {"color": NOMINAL, "linewidth": 1.3, "label": "nominal"}
    axes.plot(*(scale * walked.nominal.T), "--", **line)


def extremes(values: Array, segment: Array) -> tuple[Array, Array]:
    """Least and largest of values (T,) within each segment, by their segments (T,)."""
    starts = np.flatnonzero(np.diff(segment, prepend=-1))
    return np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)


def band(
    axes: "Axes", low: Array, high: Array, colour: str, alpha: float, label: str
) -> None:
    """Fill between extremes of segments; a line through all values would be a comb."""
    segment = np.arange(1, len(low) + 1)
    style: Style = {"color": colour, "alpha": alpha, "label": label}
    axes.fill_between(segment, low, high, step="mid", linewidth=0.4, **style)
