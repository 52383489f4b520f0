"""Fig. 7: an ellipse at constant heading in 60 segments."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from planner.paths import ellipse
from sim.figures.paper import PaperWalk, configuration, walk
from sim.figures.sheet import Sheet, Table
from sim.figures.style import IDEAL, NOMINAL, WEIGHT, as_map, letter, sheet_of
from sim.figures.tube import swing_out

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

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
    axes["b"].step(segment, widths, where="mid", color=IDEAL)
    axes["b"].set(xlabel="segment", ylabel="half width of tube  [$l$]")
    turns = _turns(walked)
    axes["c"].vlines(segment, *turns, color=IDEAL, linewidth=1.2)
    axes["c"].axhline(0, color=NOMINAL, linestyle="--")
    axes["c"].set(xlabel="segment", ylabel="heading  [rad]")
    letter(axes, {"a": "body centre", "b": "tube", "c": "heading within a segment"})
    return Sheet(
        name="fig7-ellipse-paper",
        title="Fig. 7, ellipse at constant heading, in the paper's units",
        caption=(
            "Body centre on eqs. (16) to (18), l = 1, once around an ellipse in 60 "
            "segments; the nominal heading is 0 throughout. Sideways pieces, near the "
            "ellipse's ends, need the bracket and swing out most; along the body's x "
            "axis the legs walk straight on. The paper gives no size: the semi-axes "
            f"are {SEMI_AXES[0]:g} l and {SEMI_AXES[1]:g} l, counter-clockwise from "
            "the right end."
        ),
        figure=figure,
        table=_table(walked, widths),
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
