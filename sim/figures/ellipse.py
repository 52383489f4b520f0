"""Fig. 7: an ellipse at constant heading in 60 segments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from planner import Array, ellipse
from sim.figures.paper import PaperWalk, configuration, walk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Sheet, Table, words
from sim.figures.style import (
    IDEAL,
    MM,
    NOMINAL,
    PHYSICS,
    QUASI_STATIC,
    WEIGHT,
    as_map,
    band,
    draw_walk,
    extremes,
    letter,
    sheet_of,
)
from sim.figures.tube import swing_out

if TYPE_CHECKING:
    from matplotlib.axes import Axes


PAPER_CAPTION = """
Body centre on eqs. (16) to (18), l = 1, once around an ellipse in 60 segments; the
nominal heading is 0 throughout. Sideways pieces, near the ellipse's ends, need the
bracket and swing out most; along the body's x axis the legs walk straight on. The paper
gives no size: the semi-axes are {a:g} l and {b:g} l, counter-clockwise from the right
end.
"""
METRES_CAPTION = """
Body centre of `hexapod` once around an ellipse of semi-axes 0.10 m and 0.06 m in 60
segments at constant heading, open loop with lifted fields. Loaded sweeps are centred,
so each swings to both sides of its nominal heading. (b) How far the physics is off each
prediction, from the least to the largest distance within each segment. The paper says
that the stability criteria are satisfied along this path without drawing it: (c) shows
the least margin within each segment, predicted and from measured contacts.
"""

SEGMENTS = 60
SEMI_AXES = (5.0, 3.0)  # of the shape of the scenario `ellipse`
ROWS = 12  # of the table


def paper() -> Sheet:
    """Once around with l = 1."""
    path = ellipse(configuration((0, 0, 0)), SEMI_AXES)
    walked = walk(path, SEGMENTS)
    nominal = path.at(np.linspace(0, 1, 721))[:, :2]
    widths = swing_out(walked.states[:, :2], walked.ends, nominal)
    figure, axes = sheet_of("ab\nac", 3.2, width_ratios=[1.4, 1])
    _draw_map(axes["a"], walked, nominal)
    segment = np.arange(1, SEGMENTS + 1)
    axes["b"].step(segment, widths, where="mid", color=IDEAL, label="walked")
    axes["b"].set_ylim(0, 1.35 * widths.max())  # room for the key
    axes["b"].legend(loc="upper left")
    axes["b"].set(xlabel="segment", ylabel="half width  [$l$]")
    turns = _turns(walked)
    label = "least to largest"
    band(axes["c"], *turns, color=IDEAL, alpha=0.45, label=label)
    axes["c"].axhline(0, color=NOMINAL, linestyle="--", label="nominal")
    axes["c"].set(xlabel="segment", ylabel="heading  [rad]", ylim=(-0.45, 0.75))
    axes["c"].legend(loc="upper left", ncols=2)
    titles = ("body centre", "half width of the tube", "heading within each segment")
    letter(axes, dict(zip("abc", titles, strict=True)))
    return Sheet(
        name="fig7-ellipse-paper",
        title="Fig. 7, ellipse at constant heading, in the paper's units",
        caption=words(PAPER_CAPTION, a=SEMI_AXES[0], b=SEMI_AXES[1]),
        figure=figure,
        table=_table(walked, widths),
    )


WALKS = {"ellipse": Job("ellipse")}


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """The scenario `ellipse` in the physics."""
    walked = walks["ellipse"]
    figure, axes = sheet_of("ab\nac", 3.2, width_ratios=[1.4, 1])
    draw_walk(axes["a"], walked)
    as_map(axes["a"], "mm")
    axes["a"].legend(loc="center")
    _draw_departure(axes["b"], walked)
    _draw_margin(axes["c"], walked)
    titles = ("body centre", "physics off its predictions", "least stability margin")
    letter(axes, dict(zip("abc", titles, strict=True)))
    return Sheet(
        name="fig7-ellipse-metres",
        title="Fig. 7, ellipse at constant heading, in metres",
        caption=words(METRES_CAPTION),
        figure=figure,
        table=_metres_table(walked),
    )


def _departure(walked: Walked, name: str) -> Array:
    """Distance of the physics from a prediction at every row, shape (T,) [m]."""
    apart = walked.pose["achieved"] - walked.pose[name]
    return np.hypot(*apart[:, :2].T)


def _least_margin(walked: Walked, name: str) -> Array:
    """Least margin within each segment, shape (segments,) [m]."""
    return extremes(walked.margin[name], walked.segment, walked.segments)[0]


def _draw_departure(axes: Axes, walked: Walked) -> None:
    """From the least to the largest distance within each segment."""
    for name, colour in (("ideal", IDEAL), ("quasi_static", QUASI_STATIC)):
        least, most = extremes(
            _departure(walked, name), walked.segment, walked.segments
        )
        label = f"off {name.replace('_', '-')}"
        band(axes, MM * least, MM * most, color=colour, alpha=0.55, label=label)
    axes.set(xlabel="segment", ylabel="distance  [mm]")
    axes.set_ylim(0, 1.5 * axes.get_ylim()[1])  # room for the legend
    axes.legend(loc="upper left", ncols=2)


def _draw_margin(axes: Axes, walked: Walked) -> None:
    segment = np.arange(1, walked.segments + 1)
    for name, colour, style in (("achieved", PHYSICS, "o"), ("ideal", IDEAL, "-")):
        least = MM * _least_margin(walked, name)
        label = "physics" if name == "achieved" else "predicted"
        axes.plot(segment, least, style, color=colour, markersize=2.5, label=label)
    axes.set(xlabel="segment", ylabel="margin  [mm]", ylim=(40, 60))
    axes.legend(loc="upper left", ncols=2)


def _metres_table(walked: Walked) -> Table:
    chosen = np.linspace(0, walked.segments, ROWS + 1).round().astype(int)[1:] - 1
    last = np.searchsorted(walked.segment, chosen, side="right") - 1
    margins = [_least_margin(walked, name)[chosen] for name in ("ideal", "achieved")]
    columns = [
        chosen + 1,
        *walked.pose["achieved"][last].T,
        _departure(walked, "ideal")[last],
        _departure(walked, "quasi_static")[last],
        *margins,
    ]
    return Table(
        header=(
            "segment",
            "x [m]",
            "y [m]",
            "yaw [rad]",
            "off ideal [m]",
            "off quasi-static [m]",
            "least margin predicted [m]",
            "least margin achieved [m]",
        ),  # fmt: skip
        rows=tuple(zip(*(column.tolist() for column in columns), strict=True)),
    )


def _turns(walked: PaperWalk) -> tuple[Array, Array]:
    """Least and largest heading within each segment, shape (segments,) each."""
    starts = np.concatenate([[0], walked.ends[:-1]])
    headings = [
        walked.states[a : b + 1, 2] for a, b in zip(starts, walked.ends, strict=True)
    ]
    return np.array([h.min() for h in headings]), np.array([h.max() for h in headings])


def _draw_map(axes: Axes, walked: PaperWalk, nominal: Array) -> None:
    axes.plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.6, label="walked")
    axes.plot(*nominal.T, "--", color=NOMINAL, label="nominal")
    ends = walked.states[walked.ends, :2]
    axes.plot(*ends.T, "o", color=WEIGHT, markersize=1.5, label="segment ends")
    as_map(axes, "$l$")
    axes.legend(loc="center")


def _table(walked: PaperWalk, widths: Array) -> Table:
    chosen = np.linspace(0, SEGMENTS, ROWS + 1).round().astype(int)[1:] - 1
    ends, low_high = walked.states[walked.ends], _turns(walked)
    goals = walked.plan.goal
    path = ellipse(goals, SEMI_AXES).at((chosen + 1) / SEGMENTS)
    return Table(
        header=(
            "segment",
            "x [l]",
            "y [l]",
            "yaw [rad]",
            "from the nominal [l]",
            "half width of the tube [l]",
            "least yaw [rad]",
            "largest yaw [rad]",
        ),  # fmt: skip
        rows=tuple(
            (
                int(k) + 1,
                *ends[k, :3].tolist(),
                float(np.hypot(*(ends[k] - at)[:2])),
                float(widths[k]),
                float(low_high[0][k]),
                float(low_high[1][k]),
            )
            for k, at in zip(chosen, path, strict=True)
        ),
    )
