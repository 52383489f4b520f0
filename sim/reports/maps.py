"""Paths in plan view, and errors along and across the nominal path."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from planner import Array
from sim.motion.poses import length_up_to, rotate, spaced_rows
from sim.palette import ACHIEVED, NOMINAL, OBSTACLE, PREDICTED, RUNS, THOUGHT, Style
from sim.reports.drawing import (
    Drawing,
    Key,
    add_band,
    extremes_between,
    finish,
    sheet,
    stretches,
)
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MM = 1e3
MAP_WIDTH = 4.2  # [in]
SPACING = 1 / 600  # of a path's extent, between its points
HEIGHTS = (1.8, 4.2)  # [in]
ERROR_HEIGHT = 1.75  # [in]
WAYS = ("along", "across")
DASHES: Sequence[object] = ("-", (0, (4, 1.5)), (0, (1, 1)))
NOTE = (
    "The ring is the goal. The body does not follow the nominal path itself but swings "
    "about it: it moves forward and back, and parks sideways."
)


def plan_view(run: Run) -> Drawing:
    """Nominal path, the predictions and the achieved path of the body's centre."""
    achieved = run.achieved[run.walking, :2]
    paths = {name: poses[run.walking, :2] for name, poses in run.drawn.items()}
    with sheet(_height([run]), MAP_WIDTH) as (figure, axes):
        keys = _draw_place(axes, run)
        axes.plot(*_thin(achieved).T, **ACHIEVED.line(alpha=0.55))
        keys.append(Key.of(ACHIEVED, "achieved"))
        for name, path in paths.items():
            mark, label = PREDICTED[name], name
            if name in PREDICTIONS:
                label = f"predicted, {PREDICTIONS[name].label}"
            axes.plot(*_thin(path).T, **mark.line())
            keys.append(Key.of(mark, label))
        for outline in run.thought:
            axes.plot(*(MM * outline.T), **THOUGHT.line())
        if run.thought:
            keys.append(Key.of(THOUGHT, f"{THOUGHT.label}, 90 % sure"))
        return finish(figure, "Path of the body's centre, x and y [mm]", keys, NOTE)


def errors(run: Run) -> Iterator[Drawing]:
    """Error off every prediction along the nominal path, and across it.

    Lines join the ends of segments; bands hold all that lies between.
    """
    starts, shares = stretches(run), _shares(run)
    last = np.append(starts[1:], len(run.time)) - 1
    length = MM * run.summary.path_length
    done = shares * (length or len(starts))
    names = [*run.predicted]
    for way, word in enumerate(WAYS):
        with sheet(ERROR_HEIGHT, MAP_WIDTH) as (figure, axes):
            for name in names:
                mark, error = PREDICTED[name], MM * _turned(run, name)[:, way]
                add_band(axes, done, *extremes_between(error, starts), mark.colour.hex)
                axes.plot(done[1:], error[last], **mark.line(linewidth=1.1))
            axes.set_xlim(0, done[-1])
            keys = [Key.of(PREDICTED[n], f"off {PREDICTIONS[n].label}") for n in names]
            along = "length of the path [mm]" if length else "number of the part"
            note = (
                f"To the right the {along}. Lines join the ends of its "
                f"{len(starts)} parts, pale bands hold all that lies between. Forward "
                "and to the left count as positive."
            )
            heading = f"Error {word} the path [mm]"
            both = (keys, note) if word == WAYS[-1] else ([], "")
            yield finish(figure, heading, *both)


def overlaid(runs: Sequence[tuple[str, Run]]) -> Iterator[Drawing]:
    """Achieved paths of several runs in one drawing, and their errors in another."""
    styles = [_style(number) for number in range(len(runs))]
    names = [
        Key(name, str(style["color"]), dashed=number >= len(RUNS))
        for number, ((name, _), style) in enumerate(zip(runs, styles, strict=True))
    ]
    with sheet(_height([run for _, run in runs]), MAP_WIDTH) as (figure, axes):
        known: dict[str, Key] = {}
        for _, run in runs:
            known |= {key.label: key for key in _draw_place(axes, run)}
        for (_, run), style in zip(runs, styles, strict=True):
            axes.plot(*_thin(run.achieved[run.walking, :2]).T, **style)
        heading = "Achieved paths of the body's centre, x and y [mm]"
        yield finish(figure, heading, [*known.values(), *names], NOTE)
    with sheet(HEIGHTS[1] / 1.6, MAP_WIDTH) as (figure, axes):
        for (_, run), style in zip(runs, styles, strict=True):
            off = MM * np.hypot(*run.error(run.best)[:, :2].T)
            _, most = extremes_between(off, stretches(run))
            axes.step(100 * _shares(run)[1:], most, **style)
        axes.set_xlim(0, 100)
        axes.set_ylim(bottom=0)
        note = (
            "To the right the share of the walk that is done [%]; the largest in each "
            "segment."
        )
        yield finish(figure, "Distance from the best prediction [mm]", names, note)


def _style(number: int) -> Style:
    dashes = DASHES[number // len(RUNS) % len(DASHES)]
    return {"color": RUNS[number % len(RUNS)].hex, "ls": dashes, "lw": 1.0}


def _draw_place(axes: Axes, run: Run) -> list[Key]:
    """Obstacles, nominal path and goal."""
    for outline in run.obstacles:
        axes.fill(*(MM * outline.T), color=OBSTACLE.hex, lw=0)
    axes.plot(*(MM * run.nominal[:, :2].T), **NOMINAL.line())
    ring: Style = {"mfc": "none", "mew": 1.4, "color": NOMINAL.colour.hex}
    axes.plot(*(MM * run.nominal[-1, :2]), "o", markersize=8, **ring)
    axes.set_aspect("equal", adjustable="datalim")
    return [Key.of(NOMINAL, "nominal path")]


def _shares(run: Run) -> Array:
    """Share of the walk that is done where each stretch begins, and at the end."""
    return np.linspace(0, 1, len(stretches(run)) + 1)


def _turned(run: Run, name: str) -> Array:
    """Error of the position along the nominal path and across it, (T, 2) [m].

    Where the path has no length, along is the way that the robot looked at the start.
    """
    starts, path = stretches(run), run.nominal
    middles = (np.arange(len(starts)) + 0.5) / len(starts)
    ahead = np.gradient(path[:, :2], axis=0)
    way = length_up_to(path[:, :2])
    if not way[-1]:
        return rotate(run.error(name)[:, :2], -path[0, 2])
    at = np.searchsorted(way, middles * way[-1])
    heading = np.arctan2(*ahead[np.minimum(at, len(path) - 1)].T[::-1])
    counts = np.diff(np.append(starts, len(run.time)))
    turn = np.repeat(heading, counts)
    x, y = run.error(name)[:, :2].T
    cos, sin = np.cos(turn), np.sin(turn)
    return np.stack([cos * x + sin * y, cos * y - sin * x], axis=1)


def _height(runs: Iterable[Run]) -> float:
    """Height of a map in which x and y have one scale [in]."""
    points = np.concatenate(
        [
            part
            for run in runs
            for part in (run.nominal[:, :2], run.achieved[run.walking, :2])
        ]
    )
    wide, high = np.maximum(np.ptp(points, axis=0), 1e-9)
    return float(np.clip(MAP_WIDTH * high / wide + 0.4, *HEIGHTS))


def _thin(points: Array) -> Array:
    """Points of a path about evenly apart [mm], the last one among them."""
    extent = float(np.ptp(points, axis=0).max()) or 1.0
    rows = spaced_rows(points, SPACING * extent)
    return MM * points[np.unique(np.append(rows, len(points) - 1))]
