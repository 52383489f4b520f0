"""The path in plan view, and the error beside it, magnified."""

from __future__ import annotations

import numpy as np

from planner import Array
from sim.motion.poses import spaced_rows
from sim.palette import ACHIEVED, NOMINAL, OBSTACLE, PREDICTED, THOUGHT, Style
from sim.pictures.inset import magnification
from sim.reports.drawing import Drawing, Key, finish, sheet
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

MM = 1e3
MAP_WIDTH = 4.2  # [in]
SPACING = 1 / 600  # of a path's extent, between its points
SHARE = 0.3  # of the path's extent that the largest error takes
FEWEST_ENDS = 8  # points at which the error is drawn
HEIGHTS = (1.8, 4.2)  # [in]


def plan_view(run: Run) -> Drawing:
    """Nominal path, every prediction and the achieved path of the body's centre."""
    paths = {name: p[run.walking, :2] for name, p in run.predicted.items()}
    achieved = run.achieved[run.walking, :2]
    points = np.concatenate([run.nominal[:, :2], achieved, *paths.values()])
    with sheet(_height(MM * points), MAP_WIDTH) as (figure, axes):
        for outline in run.obstacles:
            axes.fill(*(MM * outline.T), color=OBSTACLE.hex, lw=0)
        axes.plot(*(MM * run.nominal[:, :2].T), **NOMINAL.line())
        axes.plot(*_thin(achieved).T, **ACHIEVED.line(alpha=0.55))
        keys = [Key.of(NOMINAL, "nominal path"), Key.of(ACHIEVED, "achieved")]
        for name, path in paths.items():
            mark, label = PREDICTED[name], f"predicted, {PREDICTIONS[name].label}"
            axes.plot(*_thin(path).T, **mark.line())
            keys.append(Key.of(mark, label))
        for outline in run.thought:
            axes.plot(*(MM * outline.T), **THOUGHT.line())
        if run.thought:
            keys.append(Key.of(THOUGHT, f"{THOUGHT.label}, 90 % sure"))
        ring: Style = {"mfc": "none", "mew": 1.4, "color": NOMINAL.colour.hex}
        axes.plot(*np.multiply(MM, run.summary.goal[:2]), "o", markersize=8, **ring)
        axes.set_aspect("equal", adjustable="datalim")
        note = (
            "The ring is the goal. The body does not follow the nominal path itself "
            "but swings about it: it moves forward and back, and parks sideways."
        )
        return finish(figure, "Path of the body's centre, x and y [mm]", keys, note)


def magnified(run: Run) -> Drawing:
    """The nominal path with the errors at the ends of segments, magnified."""
    rows, places = _ends(run)
    errors = {name: run.error(name)[rows, :2] for name in run.predicted}
    shown = {name: e for name, e in errors.items() if name != "identified"}
    largest = max(float(np.hypot(*e.T).max()) for e in shown.values())
    extent = float(np.ptp(run.nominal[:, :2], axis=0).max()) or 0.1
    factor = max(1.0, magnification(largest, SHARE * extent)) if largest else 1.0
    drawn = {name: MM * (places + factor * e) for name, e in shown.items()}
    points = np.concatenate([MM * run.nominal[:, :2], *drawn.values()])
    keys = [Key.of(NOMINAL, "nominal path")]
    with sheet(_height(points), MAP_WIDTH) as (figure, axes):
        axes.plot(*(MM * run.nominal[:, :2].T), **NOMINAL.line())
        for name, moved in drawn.items():
            colour = PREDICTED[name].colour.hex
            axes.plot(*moved.T, "o-", color=colour, markersize=2.5, lw=0.9)
            for start, end in zip(MM * places, moved, strict=True):
                axes.plot(*np.transpose([start, end]), color=colour, lw=0.4)
            keys.append(Key(f"off the {PREDICTIONS[name].label} prediction", colour))
        axes.set_aspect("equal", adjustable="datalim")
        note = (
            "Along the nominal path, the departure of the physics from each "
            f"prediction{f', drawn {factor:g} times as long' if factor > 1 else ''}; "
            f"the longest shown is {MM * largest:.3g} mm."
        )
        enlarged = f"magnified {factor:g} times" if factor > 1 else "in its own size"
        heading = f"Error, {enlarged}, x and y [mm]"
        return finish(figure, heading, keys, note)


def _ends(run: Run) -> tuple[Array, Array]:
    """Rows at the ends of segments, and the points of the nominal path there.

    Where segments are few these are the ends of phases.
    """
    segment = np.array([phase.segment for phase in run.phases])
    changes = np.flatnonzero(np.diff(segment)) if len(segment) else np.array([], int)
    if len(changes) < FEWEST_ENDS:
        changes = np.arange(len(segment) - 1)
    ends = [run.phases[i].end for i in changes]
    last = len(run.time) - 1
    rows = np.minimum(np.searchsorted(run.time, np.array(ends) - 1e-9), last)
    rows = np.unique(np.append(rows, last).astype(int))
    shares = np.linspace(0, 1, len(rows) + 1)[1:] * (len(run.nominal) - 1)
    along_path = np.arange(len(run.nominal))
    places = [np.interp(shares, along_path, axis) for axis in run.nominal[:, :2].T]
    return rows, np.transpose(places)


def _height(points: Array) -> float:
    """Height of a map in which x and y have one scale [in]."""
    wide, high = np.maximum(np.ptp(points, axis=0), 1e-9)
    return float(np.clip(MAP_WIDTH * high / wide + 0.4, *HEIGHTS))


def _thin(points: Array) -> Array:
    """Points of a path about evenly apart [mm], the last one among them."""
    extent = float(np.ptp(points, axis=0).max()) or 1.0
    rows = spaced_rows(points, SPACING * extent)
    return MM * points[np.unique(np.append(rows, len(points) - 1))]
