"""Stratified panels: the bracket between two strata as areas of two leg angles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from models import equations, load, shipped_system
from planner import Array, Flow, play, stratified_panels
from planner.extension import StratifiedPanels
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Sheet, Table, words
from sim.figures.style import (
    DASHES,
    IDEAL,
    MM,
    NOMINAL,
    PHYSICS,
    QUASI_STATIC,
    TRIPODS,
    WEIGHT,
    as_map,
    letter,
    sheet_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STROKES = ("g1_1", "g2_2")
SIDES = (0.25, 0.5, 0.75, 1.0, 1.25)  # [rad], of tripod 1's strokes on the paper
DRAWN = 1.0  # the one that is drawn
RATIO = 0.6  # of tripod 2's strokes to them; around a square x would not change
FINE = 40  # states along a stroke
LEVELS = 13
PAPER_CAPTION = """
The bracket of the two tripods of `paper-hexapod` (that of `biped` is the same) as a
picture. Tripod 1 swings under load on S1 by {side:g} rad, tripod 2 on S2 by {ratio:g}
times as much, then both swing back, 1 first: the word of the bracket [g1_1, g2_2], a
rectangle in the plane of the two angles whose corners are changes of strata. (a), (b)
The height functions of x and y over this plane, the change of the body's centre per
area. The body moves by exactly their integral over the rectangle, Green's theorem,
because its heading is a function of the two angles; the height of the heading is 0. (c)
The body's centre along the loop. (d) Its change along loops of several sizes: as
integral, and as the flows end; at most {apart:.0e} apart. Where the loop starts, the
height is the bracket itself, (0, 2): dashed is what the bracket alone says, 2 times the
area.
"""
METRES_CAPTION = """
The same for `hexapod` in metres, with the constant fields of its contact kinematics.
(a), (b) Height functions with loops that begin at angle 0 (thin) and one of {side:g} by
{side:g} rad around the middle of the joint range (broad). (c), (d) How far each loop
moves the body in x and in y: the integral of the height function, the quasi-static
prediction of the actual legs and the physics. The integral is exact for constant fields
and not for legs: uncentred strokes also push the body aside, which shows in the small x
of loops that begin at angle 0. Around the middle this cancels, as does the height
function of x; that is what centring strokes is for.
"""
SMALL = (0.1, 0.2, 0.3, 0.4)  # [rad], sides of loops from angle 0
CENTRED = 0.8  # [rad], side of the one around the middle


def robot_panels() -> StratifiedPanels:
    """Height functions of the robot `hexapod`."""
    return stratified_panels(equations(load("hexapod")).system, STROKES)


def loops() -> dict[str, tuple[float, float, float]]:
    """Lower corner of each loop that is walked and both its sides, by its walk."""
    small = {f"panels-{side:g}": (0.0, side, RATIO * side) for side in SMALL}
    return {**small, "panels-centred": (-CENTRED / 2, CENTRED, CENTRED)}


def _job(low: float, first: float, second: float) -> Job:
    air = [Flow("2", "g2_1", low), Flow("1", "g1_2", low)] if low else []
    loop = [
        Flow("1", "g1_1", first), Flow("2", "g2_2", second),
        Flow("1", "g1_1", -first), Flow("2", "g2_2", -second),
    ]  # fmt: skip
    return Job("line", {"segments": 1}, flows=(*air, *loop))


WALKS = {name: _job(*loop) for name, loop in loops().items()}


def paper() -> Sheet:
    """On the paper's hexapod, with l = 1."""
    system = shipped_system("paper-hexapod").system
    panels = stratified_panels(system, STROKES)
    figure, axes = sheet_of("ab\ncd", 5.0)
    for name, coordinate in (("a", "x"), ("b", "y")):
        _draw_height(axes[name], panels, coordinate, 1.4, 1.0, r"$l$/rad$^2$")
        _draw_loop(axes[name], 0.0, DRAWN, RATIO * DRAWN, width=1.6)
    start = np.zeros(system.dimension)
    _draw_way(axes["c"], play(system, panels.loop((DRAWN, RATIO * DRAWN)), start, FINE))
    rows, apart = [], 0.0
    for side in SIDES:
        by = side, RATIO * side
        end = play(system, panels.loop(by), start)[-1, :2]
        by_area = [panels.change(c, (0, 0), by) for c in ("x", "y")]
        apart = max(apart, float(np.abs(end - by_area).max()))
        rows.append((*by, *by_area, *end.tolist(), 2 * by[0] * by[1]))
    _draw_changes(axes["d"], panels, rows)
    _key(figure)
    heights = {"a": "height function of x", "b": "height function of y"}
    below = {"c": "body centre along the loop", "d": "change of the body's centre"}
    letter(axes, heights | below)
    return Sheet(
        name="panels-paper",
        title="Stratified panels, the bracket as an area, in the paper's units",
        caption=words(PAPER_CAPTION, side=DRAWN, ratio=RATIO, apart=apart),
        figure=figure,
        table=Table(
            header=(
                "stroke of tripod 1 [rad]",
                "stroke of tripod 2 [rad]",
                "x by the integral [l]",
                "y by the integral [l]",
                "x by the flows [l]",
                "y by the flows [l]",
                "y by the bracket alone [l]",
            ),
            rows=tuple(rows),
        ),
    )


def _draw_height(
    axes: Axes,
    panels: StratifiedPanels,
    name: str,
    reach: float,
    scale: float,
    unit: str,
) -> None:
    """Contours of a height function over both angles from -reach to reach."""
    angles = np.linspace(-reach, reach, 81)
    first, second = np.meshgrid(angles, angles)
    values = scale * panels.at(name, first, second)
    most = np.abs(values).max()
    one_sign = values.min() > 0
    levels = np.linspace(values.min() if one_sign else -most, most, LEVELS)
    colours = "Purples" if one_sign else "PuOr"
    drawn = axes.contourf(angles, angles, values, levels, cmap=colours, alpha=0.55)
    ticks = MaxNLocator(nbins=5, steps=[1, 2, 5, 10]).tick_values(*levels[[0, -1]])
    within = [tick for tick in ticks if levels[0] <= tick <= levels[-1]]
    bar = axes.figure.colorbar(drawn, ax=axes, shrink=0.9, ticks=within, format="%.3g")
    bar.set_label(f"[{unit}]")
    bar.ax.tick_params(labelsize=6)
    axes.set(xlabel=r"$\varphi_1$  [rad]", ylabel=r"$\varphi_2$  [rad]")
    axes.set_aspect("equal")
    axes.grid(visible=False)


def _draw_loop(
    axes: Axes, low: float, first: float, second: float, width: float
) -> None:
    """A rectangle, each stroke in the colour of the tripod that stands."""
    right, top = low + first, low + second
    corners = [(low, low), (right, low), (right, top), (low, top), (low, low)]
    for number, (begin, end) in enumerate(zip(corners, corners[1:], strict=False)):
        colour = TRIPODS["1" if number % 2 == 0 else "2"]
        axes.plot(*np.transpose([begin, end]), color=colour, linewidth=width)
        if width > 1:
            middle = np.mean([begin, end], axis=0)
            nearer = middle - 0.08 * np.subtract(end, begin)
            arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": width}
            axes.annotate("", middle, nearer, arrowprops=arrow)
    axes.plot(low, low, "o", color=WEIGHT, markersize=3)


def _draw_way(axes: Axes, states: Array) -> None:
    for number in range(4):
        part = states[number * FINE : (number + 1) * FINE + 1, :2]
        colour = TRIPODS["1" if number % 2 == 0 else "2"]
        axes.plot(*part.T, color=colour, linewidth=1.4)
    axes.plot(*states[0, :2], "o", color=WEIGHT, markersize=3, label="start")
    axes.plot(*states[-1, :2], "s", color=WEIGHT, markersize=4, label="end")
    as_map(axes, "$l$")
    axes.legend(loc="center left")


def _key(figure: Figure) -> None:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=colour, label=f"tripod {tripod} stands and swings")
        for tripod, colour in TRIPODS.items()
    ]
    start: dict[str, Any] = {
        "color": WEIGHT,
        "marker": "o",
        "markersize": 3,
        "linestyle": "",
    }
    handles.append(Line2D([], [], label="start of the loop", **start))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))


def _draw_changes(
    axes: Axes, panels: StratifiedPanels, rows: list[tuple[float, ...]]
) -> None:
    sides = np.linspace(0, SIDES[-1] * 1.04, 60)
    made = np.array(rows)
    for i, (name, style) in enumerate((("x", ":"), ("y", "-"))):
        by_area = [panels.change(name, (0, 0), (s, RATIO * s)) for s in sides]
        axes.plot(sides, by_area, style, color=IDEAL, label=f"{name}, integral")
        axes.plot(made[:, 0], made[:, 4 + i], "os"[i], color=WEIGHT, markersize=4,
                  markerfacecolor="none", label=f"{name}, flows")  # fmt: skip
    alone: dict[str, Any] = {
        "linestyle": DASHES,
        "linewidth": 0.8,
        "label": "y, bracket alone",
    }
    axes.plot(sides, 2 * RATIO * sides**2, color=NOMINAL, **alone)
    axes.set(xlabel="stroke of tripod 1  [rad]", ylabel="change  [$l$]")
    axes.legend(loc="upper left")


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """Loops walked by the hexapod in the physics."""
    panels = robot_panels()
    figure, axes = sheet_of("ab\ncd", 5.0)
    for name, coordinate in (("a", "x"), ("b", "y")):
        _draw_height(axes[name], panels, coordinate, 0.45, MM, "mm/rad$^2$")
        for loop in loops().values():
            _draw_loop(axes[name], *loop, width=1.6 if loop[0] else 0.8)
    rows = [_row(panels, walks[name], *loop) for name, loop in loops().items()]
    for name, column in (("c", 3), ("d", 4)):
        _draw_bars(axes[name], rows, column)
    _key(figure)
    titles = (
        "height function of x",
        "height function of y",
        "change of x",
        "change of y",
    )
    letter(axes, dict(zip("abcd", titles, strict=True)))
    return Sheet(
        name="panels-metres",
        title="Stratified panels, the bracket as an area, in metres",
        caption=words(METRES_CAPTION, side=CENTRED),
        figure=figure,
        table=Table(
            header=(
                "loop from [rad]",
                "stroke of tripod 1 [rad]",
                "stroke of tripod 2 [rad]",
                "x by the integral [m]",
                "y by the integral [m]",
                "x quasi-static [m]",
                "y quasi-static [m]",
                "x physics [m]",
                "y physics [m]",
            ),
            rows=tuple(rows),
        ),
    )


def _row(
    panels: StratifiedPanels, walked: Walked, low: float, first: float, second: float
) -> tuple[Cell, ...]:
    by_area = [panels.change(c, (low, low), (first, second)) for c in ("x", "y")]
    ends = (walked.pose[name][-1, :2].tolist() for name in ("quasi_static", "achieved"))
    return (low, first, second, *by_area, *(value for end in ends for value in end))


def _draw_bars(axes: Axes, rows: list[tuple[Cell, ...]], column: int) -> None:
    made = MM * np.array([row[column::2] for row in rows], dtype=float)  # (loops, 3)
    kinds = (("integral", IDEAL), ("quasi-static", QUASI_STATIC), ("physics", PHYSICS))
    for i, (label, colour) in enumerate(kinds):
        at = np.arange(len(rows)) + 0.27 * (i - 1)
        axes.bar(at, made[:, i], width=0.25, color=colour, label=label)
    names = [f"{row[1]:g}\nby {row[2]:.2g}" for row in rows]
    names[-1] += "\naround 0"
    axes.set_xticks(range(len(rows)), names)
    axes.axhline(0, color=WEIGHT, linewidth=0.6)
    axes.set(xlabel="sides of the loop  [rad]", ylabel="change  [mm]")
    axes.legend(loc="best")
