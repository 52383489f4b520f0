"""Fig. 8: footprints along a diagonal, turning a quarter on the way."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from planner.paths import line
from sim.figures.footprints import Footprints, footprints
from sim.figures.paper import PaperWalk, configuration, feet, standing, walk
from sim.figures.sheet import Sheet, Table
from sim.figures.style import IDEAL, NOMINAL, TRIPODS, WEIGHT, as_map, letter, sheet_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

GOAL = (4.0, 4.0, math.pi / 2)
SEGMENTS = 12
LEGS: Mapping[str, Sequence[int]] = {"1": (1, 4, 5), "2": (2, 3, 6)}


def paper() -> Sheet:
    """With l = 1, feet standing still."""
    path = line(configuration((0, 0, 0)), configuration(GOAL))
    walked = walk(path, SEGMENTS, fields="lifted")
    prints = footprints(feet(walked), standing(walked))
    figure, axes = sheet_of("ab", 3.5)
    _draw_tripods(axes["a"], prints)
    _draw_walk(axes["b"], walked)
    letter(axes, {"a": "footprints", "b": "body centre and heading"})
    return Sheet(
        name="fig8-diagonal-paper",
        title="Fig. 8, footprints of a turning walk, in the paper's units",
        caption=(
            "Footprints on eqs. (17) and (18), l = 1, from (0, 0, 0) to (4, 4, pi/2) "
            f"in {SEGMENTS} segments. The paper gives neither path nor feet. A foot "
            "that stands still under these equations is carried around its tripod's "
            "pivot beside the body, (0, l) or (0, -l); feet lie where those of the "
            "robot `hexapod` do, measured in its pivots' distance. Steered with lifted "
            "fields: with the paper's own, a tripod swings while both are loaded, and "
            "no foot would leave one print. The body walks the same way with either."
        ),
        figure=figure,
        table=_table(prints),
    )


def _table(prints: Footprints) -> Table:
    rows = []
    for tripod, legs in LEGS.items():
        for leg in legs:
            of = prints.foot == leg - 1
            first, last = prints.place[of][0].tolist(), prints.place[of][-1].tolist()
            slid = float(prints.slid[of].max())
            rows.append((tripod, leg, int(of.sum()), *first, *last, slid))
    return Table(
        header=(
            "tripod",
            "leg",
            "footprints",
            "first x [l]",
            "first y [l]",
            "last x [l]",
            "last y [l]",
            "largest slide [l]",
        ),  # fmt: skip
        rows=tuple(rows),
    )


def _draw_tripods(axes: Axes, prints: Footprints) -> None:
    markers = {"1": "^", "2": "v"}
    for tripod, legs in LEGS.items():
        of = np.isin(prints.foot, np.array(legs) - 1)
        axes.plot(
            *prints.place[of].T,
            markers[tripod],
            color=TRIPODS[tripod],
            markersize=3,
            markeredgewidth=0,
            alpha=0.8,
            label=f"tripod {tripod}, legs {'-'.join(map(str, legs))}",
        )
    as_map(axes, "$l$")
    axes.legend(loc="upper left")


def _draw_walk(axes: Axes, walked: PaperWalk) -> None:
    axes.plot([0, GOAL[0]], [0, GOAL[1]], "--", color=NOMINAL, label="nominal")
    axes.plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.8, label="body centre")
    ends = walked.states[np.concatenate([[0], walked.ends])]
    axes.quiver(
        *ends[:, :2].T,
        np.cos(ends[:, 2]),
        np.sin(ends[:, 2]),
        angles="xy",
        scale_units="xy",
        scale=2,
        width=0.004,
        color=WEIGHT,
        zorder=3,
    )
    axes.plot([], [], color=WEIGHT, marker=">", label="heading at segment ends")
    as_map(axes, "$l$")
    axes.legend(loc="upper left")
