"""Paths in plan view, and errors along and across the nominal path."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import cycle, product
from typing import TYPE_CHECKING

import numpy as np

from planner import Array
from sim import palette
from sim.evaluation.quantities import ROWS
from sim.motion.poses import length_up_to, rotate, spaced_rows
from sim.reports.drawing import (
    FEW,
    MM,
    NOTES,
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

MAP_WIDTH = 4.2  # [in]
SPACING = 1 / 600  # of a path's extent, between its points
HEIGHTS = (1.8, 4.2)  # [in]
WAYS = ("along", "across")
DASHES: Sequence[tuple[float, ...]] = ((), (4.0, 1.5), (1.0, 1.0))
ARROWS, TURNED = 8, 0.1  # at most, on a path that turns by more [rad]


def plan_view(run: Run) -> Drawing:
    """Nominal path, the predictions and the achieved path of the body's centre."""
    with sheet(_height([run]), MAP_WIDTH) as (figure, axes):
        keys = _draw_place(axes, run)
        axes.plot(*_walked(run, run.achieved), **palette.ACHIEVED.line(alpha=0.55))
        keys.append(Key.of(palette.ACHIEVED, "achieved"))
        for name, poses in run.drawn.items():
            label = f"predicted, {ROWS[name]}" if name in PREDICTIONS else ROWS[name]
            axes.plot(*_walked(run, poses), **palette.PREDICTED[name].line())
            keys.append(Key.of(palette.PREDICTED[name], label))
        for outline in run.thought:
            axes.plot(*(MM * outline.T), **palette.THOUGHT.line())
        if run.thought:
            keys.append(Key.of(palette.THOUGHT, f"{palette.THOUGHT.label}, 90 % sure"))
        note = "" if run.scenario.motion else NOTES["plan"]
        if np.ptp(np.unwrap(run.nominal[:, 2])) > TURNED:
            note += NOTES["front"]
            _draw_headings(axes, run)
        return finish(figure, "Path of the body's centre, x and y [mm]", keys, note)


def _draw_headings(axes: "Axes", run: Run) -> None:
    """Arrows on the achieved path, where segments begin and at its end."""
    poses = run.achieved[np.append(stretches(run), -1)]
    every = np.linspace(0, len(poses) - 1, min(ARROWS, len(poses))).round().astype(int)
    x, y, yaw = poses[every].T
    look: palette.Style = {"width": 0.008, "scale": 11, "zorder": 3}
    ahead = np.cos(yaw), np.sin(yaw)
    axes.quiver(MM * x, MM * y, *ahead, color=palette.ACHIEVED.colour.hex, **look)


def errors(run: Run) -> Iterator[Drawing]:
    """Errors along the nominal path and across it: ends of segments, and bands."""
    starts = stretches(run)
    last = np.append(starts[1:], len(run.time)) - 1
    length = MM * run.summary.path_length
    done = np.linspace(0, length or len(starts), len(starts) + 1)
    marks = {name: palette.PREDICTED[name] for name in run.compared}
    for way, word in enumerate(WAYS):
        with sheet(1.75, MAP_WIDTH) as (figure, axes):  # [in]
            for name, mark in marks.items():
                error = MM * _turned(run, name)[:, way]
                add_band(axes, done, *extremes_between(error, starts), mark.colour.hex)
                axes.plot(done[1:], error[last], **mark.line(linewidth=1.1))
            axes.set_xlim(0, done[-1])
            keys = [Key.of(m, f"off {ROWS[n]}") for n, m in marks.items()]
            kind = "segment" if len(starts) == run.segments else "phase"
            along = "length of the path [mm]" if length else f"number of the {kind}"
            note = NOTES["errors"].format(along=along, count=len(starts), kind=kind)
            both = (keys, note) if word == WAYS[-1] else ([], "")
            yield finish(figure, f"Error {word} the path [mm]", *both)


def best_of(runs: Iterable[Run]) -> str:
    """The prediction by which runs are judged, in words."""
    labels = {PREDICTIONS[run.best].label for run in runs}
    return f"the {labels.pop() if len(labels) == 1 else 'best'} prediction"


def overlaid(runs: Sequence[tuple[str, Run]]) -> Iterator[Drawing]:
    """Achieved paths of several runs in one drawing, and how far off they are."""
    widths = np.linspace(2.0, 0.8, len(runs))
    looks = cycle(product(DASHES, palette.RUNS))
    marks = [
        palette.PathMark(name, colour, 0.0, width, dashes)
        for (name, _), width, (dashes, colour) in zip(runs, widths, looks, strict=False)
    ]
    styles, names = [m.line() for m in marks], [Key.of(m, m.label) for m in marks]
    with sheet(_height([run for _, run in runs]), MAP_WIDTH) as (figure, axes):
        known = {k.label: k for _, run in runs for k in _draw_place(axes, run)}
        for (_, run), style in zip(runs, styles, strict=True):
            if (real := run.compared.get("measured")) is not None:
                axes.plot(*_walked(run, real), **palette.PREDICTED["measured"].line())
                known["measured"] = Key.of(palette.PREDICTED["measured"], "measured")
            axes.plot(*_walked(run, run.achieved), **style)
        heading = "Achieved paths of the body's centre, x and y [mm]"
        note = "" if runs[0][1].scenario.motion else NOTES["plan"]
        yield finish(figure, heading, [*known.values(), *names], note)
    best = best_of([run for _, run in runs])
    few = any(run.segments < FEW for _, run in runs)  # then phases, for all runs
    for what, key in ((best, ""), ("the measured body", "measured")):
        if not all((key or run.best) in run.compared for _, run in runs):
            continue
        with sheet(HEIGHTS[1] / 1.6, MAP_WIDTH) as (figure, axes):
            for (_, run), style in zip(runs, styles, strict=True):
                off = MM * np.hypot(*run.error(key or run.best)[:, :2].T)
                _, most = extremes_between(off, stretches(run, few))
                axes.step(np.linspace(0, 100, len(most) + 1)[1:], most, **style)
            axes.set_xlim(0, 100)
            axes.set_ylim(bottom=0)
            yield finish(figure, f"Distance from {what} [mm]", names, NOTES["shares"])


def _draw_place(axes: "Axes", run: Run) -> list[Key]:
    for outline in run.obstacles:
        axes.fill(*(MM * outline.T), color=palette.OBSTACLE.hex, lw=0)
    axes.plot(*(MM * run.nominal[:, :2].T), **palette.NOMINAL.line())
    ring: palette.Style = {"markersize": 8, "mfc": "none", "mew": 1.4}
    ring["color"] = palette.NOMINAL.colour.hex
    axes.plot(*(MM * run.nominal[-1, :2]), "o", **ring)
    axes.set_aspect("equal", adjustable="datalim")
    return [Key.of(palette.NOMINAL, ", ".join(run.path_labels))]


def _turned(run: Run, name: str) -> Array:
    """Error of the position along the nominal path and across it, (T, 2) [m].

    Where the path has no length, along is the way that the robot looked at the start.
    """
    starts, path, error = stretches(run), run.nominal, run.error(name)[:, :2]
    way = length_up_to(path[:, :2])
    if not way[-1]:
        return rotate(error, -path[0, 2])
    middles = (np.arange(len(starts)) + 0.5) / len(starts)
    at = np.minimum(np.searchsorted(way, middles * way[-1]), len(path) - 1)
    heading = np.arctan2(*np.gradient(path[:, :2], axis=0)[at].T[::-1])
    return rotate(error, -np.repeat(heading, np.diff(np.append(starts, len(error)))))


def _height(runs: Iterable[Run]) -> float:
    """Height of a map in which x and y have one scale [in]."""
    parts = ((run.nominal, run.achieved[run.walking]) for run in runs)
    points = np.concatenate([part[:, :2] for both in parts for part in both])
    wide, high = np.maximum(np.ptp(points, axis=0), 1e-9)
    return float(np.clip(MAP_WIDTH * high / wide + 0.4, *HEIGHTS))


def _walked(run: Run, poses: Array) -> Array:
    """Points of a path about evenly apart, the last one among them, (2, N) [mm]."""
    points = poses[run.walking, :2]
    rows = spaced_rows(points, SPACING * (float(np.ptp(points, axis=0).max()) or 1.0))
    return MM * points[np.unique(np.append(rows, len(points) - 1))].T
