"""Stratified panels: the bracket between two strata as areas of two leg angles."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from models import equations, load, shipped_system
from planner import Array, Flow, play, stratified_panels
from planner.extension import StratifiedPanels
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Shown
from sim.figures.style import IDEAL, INK, MM, NOMINAL, PHYSICS, QUASI_STATIC, TRIPODS
from sim.palette import Style

STROKES = ("g1_1", "g2_2")
SIDES = (0.25, 0.5, 0.75, 1.0, 1.25)  # [rad], of tripod 1's strokes on the paper
DRAWN_SIDE = 1.0  # the one that is drawn
RATIO = 0.6  # of tripod 2's strokes to them; around a square x would not change
STROKE_STATES = 40  # states along a stroke
LEVELS = 13
ENDS = 0.08  # of a colour bar
SMALL = (0.1, 0.2, 0.3, 0.4)  # [rad], sides of loops from angle 0
CENTRED = 0.8  # [rad], side of the one around the middle


def loops() -> dict[str, tuple[float, float, float]]:
    """Lower corner of each loop that is walked and both its sides, by its walk."""
    small: Style = {f"panels-{side:g}": (0.0, side, RATIO * side) for side in SMALL}
    return {**small, "panels-centred": (-CENTRED / 2, CENTRED, CENTRED)}


def _job(low: float, first: float, second: float) -> Job:
    air = (Flow("2", "g2_1", low), Flow("1", "g1_2", low)) if low else ()
    sides = ("1", "g1_1", first), ("2", "g2_2", second)
    loop = (Flow(s, g, sign * by) for sign in (1, -1) for s, g, by in sides)
    return Job("line", {"segments": 1}, flows=(*air, *loop))


WALKS = {name: _job(*loop) for name, loop in loops().items()}


def paper(axes: Mapping[str, Axes]) -> Shown:
    """On the paper's hexapod, with l = 1."""
    system = shipped_system("paper-hexapod").system
    panels = stratified_panels(system, STROKES)
    drawn = DRAWN_SIDE, RATIO * DRAWN_SIDE
    for panel, coordinate in (("a", "x"), ("b", "y")):
        _draw_height(axes[panel], panels, coordinate, 1.4, "$l$")
        _draw_loop(axes[panel], 0.0, *drawn, width=1.6)
    start = np.zeros(system.dimension)
    _draw_way(axes["c"], play(system, panels.loop(drawn), start, STROKE_STATES))
    rows, apart = [], 0.0
    for side in SIDES:
        by = side, RATIO * side
        end = play(system, panels.loop(by), start)[-1, :2]
        by_area = [panels.change(c, (0, 0), by) for c in ("x", "y")]
        apart = max(apart, float(np.abs(end - by_area).max()))
        rows.append((*by, *by_area, *end.tolist(), 2 * by[0] * by[1]))
    _draw_changes(axes["d"], panels, rows)
    return Shown(rows, {"side": DRAWN_SIDE, "ratio": RATIO, "apart": apart})


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """Loops walked by the hexapod in the physics."""
    panels, rows = stratified_panels(equations(load("hexapod")).system, STROKES), []
    for panel, coordinate in (("a", "x"), ("b", "y")):
        _draw_height(axes[panel], panels, coordinate, 0.45, "mm")
        for loop in loops().values():
            _draw_loop(axes[panel], *loop, width=1.6 if loop[0] else 0.8)
    for walk, (low, first, second) in loops().items():
        by_area = [panels.change(c, (low, low), (first, second)) for c in ("x", "y")]
        poses = (walks[walk].pose[name] for name in ("quasi_static", "achieved"))
        ends = np.concatenate([pose[-1, :2] for pose in poses]).tolist()
        rows.append((low, first, second, *by_area, *ends))
    for panel, column in (("c", 3), ("d", 4)):
        _draw_bars(axes[panel], rows, column)
    return Shown(rows, {"side": CENTRED})


def _draw_height(
    axes: Axes, panels: StratifiedPanels, name: str, reach: float, unit: str
) -> None:
    """Contours of a height function over both angles from -reach to reach."""
    scale = MM if unit == "mm" else 1.0
    angles = np.linspace(-reach, reach, 81)
    first, second = np.meshgrid(angles, angles)
    values = scale * panels.at(name, first, second)
    most = np.abs(values).max()
    one_sign = values.min() > 0
    levels = np.linspace(values.min() if one_sign else -most, most, LEVELS)
    colours = "Purples" if one_sign else "PuOr"
    drawn = axes.contourf(angles, angles, values, levels, cmap=colours, alpha=0.55)
    low, high = levels[[0, -1]]
    inner = MaxNLocator(nbins=4, steps=[1, 2, 5, 10]).tick_values(low, high)
    apart = ENDS * (high - low)  # of ticks, so that their numbers do not meet
    at = [low, *[t for t in inner if low + apart < t < high - apart], high]
    bar = axes.figure.colorbar(drawn, ax=axes, shrink=0.9, ticks=at, format="{x:.3g}")
    bar.set_label(f"[{unit}/rad$^2$]")
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
    for number, (begin, end) in enumerate(pairwise(corners)):
        colour = TRIPODS["12"[number % 2]]
        axes.plot(*np.transpose([begin, end]), color=colour, linewidth=width)
        if width > 1:
            middle = np.mean([begin, end], axis=0)
            nearer = middle - 0.08 * np.subtract(end, begin)
            arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": width}
            axes.annotate("", middle, nearer, arrowprops=arrow)
    axes.plot(low, low, "o", color=INK, markersize=3)


def _draw_way(axes: Axes, states: Array) -> None:
    for number in range(4):
        part = states[number * STROKE_STATES : (number + 1) * STROKE_STATES + 1, :2]
        axes.plot(*part.T, color=TRIPODS["12"[number % 2]], linewidth=1.4)
    axes.plot(*states[0, :2], "o", color=INK, markersize=3, label="start")
    axes.plot(*states[-1, :2], "s", color=INK, markersize=4, label="end")


def _draw_changes(
    axes: Axes, panels: StratifiedPanels, rows: list[tuple[float, ...]]
) -> None:
    sides = np.linspace(0, SIDES[-1] * 1.04, 60)
    made = np.array(rows)
    for i, (name, fmt) in enumerate((("x", ":"), ("y", "-"))):
        by_area = [panels.change(name, (0, 0), (s, RATIO * s)) for s in sides]
        axes.plot(sides, by_area, fmt, color=IDEAL, label=f"{name}, integral")
        flows: Style = {"color": INK, "mfc": "none", "label": f"{name}, flows"}
        axes.plot(made[:, 0], made[:, 4 + i], "os"[i], markersize=4, **flows)
    alone: Style = {"linewidth": 0.8, "label": "y, bracket alone"}
    axes.plot(sides, 2 * RATIO * sides**2, "--", color=NOMINAL, **alone)


def _draw_bars(axes: Axes, rows: list[tuple[Cell, ...]], column: int) -> None:
    made = MM * np.array([row[column::2] for row in rows], dtype=float)  # (loops, 3)
    kinds = (("integral", IDEAL), ("quasi-static", QUASI_STATIC), ("physics", PHYSICS))
    for i, (label, colour) in enumerate(kinds):
        at = np.arange(len(rows)) + 0.27 * (i - 1)
        axes.bar(at, made[:, i], width=0.25, color=colour, label=label)
    names = [f"{row[1]:g}\nby {row[2]:.2g}" for row in rows]
    names[-1] += "\naround 0"
    axes.set_xticks(range(len(rows)), names)
