"""The configuration space of a biped near both feet on the ground: two sheets crossing.

Shown are the heights of both feet and one further coordinate. On S1 foot 1 stands and
foot 2 may rise; on S2 the other way about; they cross where both stand, in S12.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from planner import Array
from sim.figures.style import TRIPODS, WEIGHT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

VIEW = {"elev": 24, "azim": -52}
STRATA = {"12": WEIGHT, "1": TRIPODS["1"], "2": TRIPODS["2"]}
"""Colour of what happens on each stratum."""


def draw_sheets(axes: Any, span: tuple[float, float], top: float = 1.25) -> None:
    """Draw S1 and S2 as rectangles that share the line S12.

    Args:
        axes: Axes with a 3-D projection.
        span: Lowest and highest value of the coordinate along S12.
        top: Largest height of a foot.
    """
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    low, high = span
    first = [(low, 0, 0), (high, 0, 0), (high, 0, top), (low, 0, top)]
    second = [(low, 0, 0), (high, 0, 0), (high, top, 0), (low, top, 0)]
    for corners, stratum in ((first, "1"), (second, "2")):
        axes.add_collection3d(
            Poly3DCollection(
                [corners], facecolor=STRATA[stratum], alpha=0.12, edgecolor="none"
            )
        )
    axes.plot([low, high], [0, 0], [0, 0], color=WEIGHT, linewidth=1.2)
    axes.text(high, 0, top, "$S_1$", color=STRATA["1"], ha="right", va="top")
    axes.text(high, top, 0.02, "$S_2$", color=STRATA["2"], ha="right")
    axes.text(high, 0, 0, " $S_{12}$", ha="left", va="top")
    axes.text(high, top, top, "$h_2$", ha="center", va="bottom")
    axes.set(xlim=span, ylim=(0, top), zlim=(0, top))
    axes.set_ylabel("$h_1$", labelpad=-10)
    axes.set(yticks=(1,), zticks=(1,))
    axes.tick_params(pad=-4)
    axes.view_init(**VIEW)
    axes.set_box_aspect((1.5, 1.1, 1.0), zoom=1.2)
    axes.grid(visible=False)
    for pane in (axes.xaxis, axes.yaxis, axes.zaxis):
        pane.set_pane_color((1, 1, 1, 0))


def draw_way(axes: Axes, points: Array, strata: Sequence[str]) -> None:
    """Draw a way through both sheets, coloured by the stratum it is on.

    Args:
        axes: Axes with a 3-D projection.
        points: The further coordinate and the heights of feet 1 and 2, shape (N, 3).
        strata: Of each step from one point to the next, N - 1 of them.
    """
    changes = [0, *(np.flatnonzero(np.array(strata[1:]) != strata[:-1]) + 1)]
    for begin, end in zip(changes, [*changes[1:], len(strata)], strict=True):
        axes.plot(
            *points[begin : end + 1].T, color=STRATA[strata[begin]], linewidth=1.6
        )
