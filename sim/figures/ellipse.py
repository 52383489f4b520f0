"""Fig. 7: an ellipse at constant heading in 60 segments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner import Array, ellipse
from sim.figures.paper import PaperWalk, configuration, swing_out, walk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Shown, rows_of
from sim.figures.style import (
    IDEAL,
    INK,
    MM,
    NOMINAL,
    PHYSICS,
    QUASI_STATIC,
    as_map,
    band,
    draw_walk,
    extremes,
)
from sim.palette import Style

if TYPE_CHECKING:
    from matplotlib.axes import Axes


SEGMENTS_AROUND = 60
SEMI_AXES = (5.0, 3.0)  # of the shape of the scenario `ellipse`
TABLE_ROWS = 12
WALKS = {"ellipse": Job("ellipse")}


def paper(axes: Mapping[str, Axes]) -> Shown:
    """Once around with l = 1."""
    path = ellipse(configuration((0, 0, 0)), SEMI_AXES)
    walked = walk(path, SEGMENTS_AROUND)
    nominal = path.at(np.linspace(0, 1, 721))[:, :2]
    widths = swing_out(walked.states[:, :2], walked.ends, nominal)
    turns = _turns(walked)
    axes["a"].plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.6, label="walked")
    axes["a"].plot(*nominal.T, "--", color=NOMINAL, label="nominal")
    dots: Style = {"color": INK, "markersize": 1.5, "label": "segment ends"}
    axes["a"].plot(*walked.states[walked.ends, :2].T, "o", **dots)
    as_map(axes["a"], "$l$")
    axes["a"].legend(loc="center")
    segment = np.arange(1, SEGMENTS_AROUND + 1)
    axes["b"].step(segment, widths, where="mid", color=IDEAL, label="walked")
    axes["b"].set(xlabel="segment", ylabel="half width  [$l$]")
    axes["b"].set_ylim(0, 1.35 * widths.max())  # room for the key
    axes["b"].legend(loc="upper left")
    band(axes["c"], *turns, colour=IDEAL, alpha=0.45, label="least to largest")
    axes["c"].axhline(0, color=NOMINAL, linestyle="--", label="nominal")
    axes["c"].set(xlabel="segment", ylabel="heading  [rad]", ylim=(-0.45, 0.75))
    axes["c"].legend(loc="upper left", ncols=2)
    k = _chosen(SEGMENTS_AROUND)
    ends = walked.states[walked.ends][k]
    goals = ellipse(walked.plan.goal, SEMI_AXES).at((k + 1) / SEGMENTS_AROUND)
    off = np.hypot(*(ends - goals)[:, :2].T)
    return Shown(
        rows_of(k + 1, *ends[:, :3].T, off, widths[k], *(turn[k] for turn in turns)),
        {"a": SEMI_AXES[0], "b": SEMI_AXES[1]},
    )


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """The scenario `ellipse` in the physics."""
    walked = walks["ellipse"]
    draw_walk(axes["a"], walked)
    as_map(axes["a"], "mm")
    axes["a"].legend(loc="center")
    off = {}
    for name, colour in (("ideal", IDEAL), ("quasi_static", QUASI_STATIC)):
        apart = walked.pose["achieved"] - walked.pose[name]
        off[name] = np.hypot(*apart[:, :2].T)  # at every row
        spread = extremes(MM * off[name], walked.segment, walked.segments)
        label = f"off {name.replace('_', '-')}"
        band(axes["b"], *spread, colour=colour, alpha=0.55, label=label)
    axes["b"].set(xlabel="segment", ylabel="distance  [mm]")
    axes["b"].set_ylim(0, 1.5 * axes["b"].get_ylim()[1])  # room for the legend
    axes["b"].legend(loc="upper left", ncols=2)
    margins = {
        name: extremes(walked.margin[name], walked.segment, walked.segments)[0]
        for name in ("ideal", "achieved")
    }
    segment = np.arange(1, walked.segments + 1)
    for name, label, style, colour in (
        ("achieved", "physics", "o", PHYSICS),
        ("ideal", "predicted", "-", IDEAL),
    ):
        dots: Style = {"color": colour, "markersize": 2.5, "label": label}
        axes["c"].plot(segment, MM * margins[name], style, **dots)
    axes["c"].set(xlabel="segment", ylabel="margin  [mm]", ylim=(40, 60))
    axes["c"].legend(loc="upper left", ncols=2)
    k = _chosen(walked.segments)
    last = np.searchsorted(walked.segment, k, side="right") - 1
    ends = walked.pose["achieved"][last].T
    least = (margin[k] for margin in margins.values())
    return Shown(rows_of(k + 1, *ends, *(o[last] for o in off.values()), *least))


def _chosen(segments: int) -> Array:
    """Segments in the table, from 0, evenly spread."""
    return np.linspace(0, segments, TABLE_ROWS + 1).round().astype(int)[1:] - 1


def _turns(walked: PaperWalk) -> tuple[Array, Array]:
    """Least and largest heading within each segment, shape (segments,) each."""
    starts = np.concatenate([[0], walked.ends[:-1]])
    headings = [
        walked.states[a : b + 1, 2] for a, b in zip(starts, walked.ends, strict=True)
    ]
    return np.array([h.min() for h in headings]), np.array([h.max() for h in headings])
