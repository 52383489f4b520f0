"""Fig. 8: footprints along a diagonal, turning a quarter on the way."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from planner import Array, line
from sim.figures.footprints import Footprints, footprints
from sim.figures.paper import PaperWalk, configuration, feet, standing, walk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Sheet, Table, words
from sim.figures.style import (
    IDEAL,
    MM,
    NOMINAL,
    TRIPODS,
    WEIGHT,
    as_map,
    letter,
    sheet_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes


GOAL = (4.0, 4.0, math.pi / 2)
SEGMENTS = 12
COUNTED = "footprints of each leg so far"
MARKERS = {"1": "^", "2": "v"}
PAPER_CAPTION = """
Footprints on eqs. (17) and (18), l = 1, from (0, 0, 0) to (4, 4, pi/2) in {segments}
segments. The paper gives neither path nor feet. A foot that stands still under these
equations is carried around its tripod's pivot beside the body, (0, l) or (0, -l); feet
lie where those of the robot `hexapod` do, measured in its pivots' distance. Numbers:
legs, at their first print; lines join the prints of a foot in the order of time.
Steered with lifted fields: with the paper's own, a tripod swings while both are loaded,
and no foot would leave one print. The body walks the same way with either.
"""
METRES_CAPTION = """
Footprints of `hexapod` from (0, 0, 0) to (0.15 m, 0.15 m, pi/2) in 30 segments, open
loop with lifted fields: {count} stays of six feet on the ground, each shown by the
place of the foot in the middle of its stay. Numbers: legs, at their first footprint.
Planned: on the ideal prediction, at the commanded angles of the legs. Found: measured
contact points. A foot of two joints cannot turn exactly about its tripod's pivot, so it
slides while it stands; as strokes are centred it slides back again, and little is left
when it is lifted (c).
"""
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
        caption=words(PAPER_CAPTION, segments=SEGMENTS),
        figure=figure,
        table=_table(prints),
    )


WALKS = {"diagonal": Job("diagonal")}


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """The scenario `diagonal` in the physics."""
    walked = walks["diagonal"]
    planned, found = (
        footprints(walked.feet[name], walked.contact[name])
        for name in ("planned", "achieved")
    )
    figure, axes = sheet_of("ab\nac", 3.8, width_ratios=[1.5, 1])
    _draw_both(axes["a"], planned, found)
    apart = matched(planned, found)
    _draw_apart(axes["b"], planned, apart)
    _draw_slides(axes["c"], planned, found)
    handles, labels = axes["a"].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower left", ncols=len(labels))
    titles = ("footprints", "found off planned", "slide while a foot stands")
    letter(axes, dict(zip("abc", titles, strict=True)))
    return Sheet(
        name="fig8-diagonal-metres",
        title="Fig. 8, footprints of a turning walk, in metres",
        caption=words(METRES_CAPTION, count=len(planned.foot)),
        figure=figure,
        table=_metres_table(planned, found, apart),
    )


def matched(planned: Footprints, found: Footprints) -> Array:
    """Distance of each planned print from the one found in its place, (K,) [m].

    Raises:
        ValueError: The feet did not stand as often as planned.
    """
    if not np.array_equal(planned.foot, found.foot):
        raise ValueError(
            f"{len(found.foot)} footprints found for {len(planned.foot)} planned"
        )
    return np.hypot(*(found.place - planned.place).T)


def _draw_both(axes: Axes, planned: Footprints, found: Footprints) -> None:
    for tripod, legs in LEGS.items():
        of = np.isin(planned.foot, np.array(legs) - 1)
        marker, colour = MARKERS[tripod], TRIPODS[tripod]
        axes.plot(
            *(MM * planned.place[of].T), marker, color=colour, markersize=4.5,
            markerfacecolor="none", markeredgewidth=0.5,
            label=f"tripod {tripod}, planned",
        )  # fmt: skip
        axes.plot(
            *(MM * found.place[of].T), ".", color=colour, markersize=2,
            label=f"tripod {tripod}, found",
        )  # fmt: skip
        for leg in legs:
            first = planned.place[planned.foot == leg - 1][0]
            _number(axes, leg, MM * first, colour)
    as_map(axes, "mm")


def _number(axes: Axes, leg: int, place: Array, colour: str) -> None:
    """The number of a leg beside its first footprint."""
    x, y = place
    axes.annotate(
        str(leg), (x, y), (-4, -4), textcoords="offset points", ha="right", va="top",
        color=colour, fontsize=8, fontweight="bold", zorder=4,
        bbox={"boxstyle": "circle,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8},
    )  # fmt: skip


def _draw_apart(axes: Axes, planned: Footprints, apart: Array) -> None:
    for tripod, legs in LEGS.items():
        of = np.isin(planned.foot, np.array(legs) - 1)
        order = np.argsort(planned.begin[of])
        axes.plot(
            np.arange(of.sum()) / len(legs), MM * apart[of][order], MARKERS[tripod],
            color=TRIPODS[tripod], markersize=2.5, markeredgewidth=0,
            label=f"tripod {tripod}",
        )  # fmt: skip
    axes.set(xlabel=COUNTED, ylabel="distance  [mm]")
    axes.set_ylim(0, 1.3 * axes.get_ylim()[1])  # room for the key
    axes.legend(loc="upper right", ncols=2, markerscale=2)


def _draw_slides(axes: Axes, planned: Footprints, found: Footprints) -> None:
    ideal = dict.fromkeys(LEGS, "_") | {"1": "ideal"}
    for tripod, legs in LEGS.items():
        of = np.isin(planned.foot, np.array(legs) - 1)
        order = np.argsort(planned.begin[of])
        stays = np.arange(of.sum()) / len(legs)
        axes.plot(
            stays, MM * found.slid[of][order], MARKERS[tripod], color=TRIPODS[tripod],
            markersize=2.5, markeredgewidth=0, label=f"tripod {tripod}",
        )  # fmt: skip
        axes.plot(
            stays, MM * planned.slid[of][order], ".", color=WEIGHT, markersize=1.5,
            markeredgewidth=0, label=ideal[tripod],
        )  # fmt: skip
    axes.set(xlabel=COUNTED, ylabel="slide  [mm]")
    axes.set_ylim(0, 1.3 * axes.get_ylim()[1])  # room for the key
    axes.legend(loc="upper right", ncols=3, markerscale=2, columnspacing=1)


def _metres_table(planned: Footprints, found: Footprints, apart: Array) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for tripod, legs in LEGS.items():
        for leg in legs:
            of = planned.foot == leg - 1
            slides = float(planned.slid[of].max()), float(found.slid[of].max())
            off = float(apart[of].mean()), float(apart[of].max())
            rows.append((tripod, leg, int(of.sum()), *off, *slides))
    return Table(
        header=(
            "tripod",
            "leg",
            "footprints",
            "mean off planned [m]",
            "most off planned [m]",
            "longest slide at the end of a stay, ideal [m]",
            "longest slide at the end of a stay, physics [m]",
        ),  # fmt: skip
        rows=tuple(rows),
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
            "longest slide at the end of a stay [l]",
        ),  # fmt: skip
        rows=tuple(rows),
    )


def _draw_tripods(axes: Axes, prints: Footprints) -> None:
    for tripod, legs in LEGS.items():
        for leg in legs:
            places = prints.place[prints.foot == leg - 1]
            axes.plot(*places.T, color=TRIPODS[tripod], linewidth=0.3, alpha=0.5)
            _number(axes, leg, places[0], TRIPODS[tripod])
        of = np.isin(prints.foot, np.array(legs) - 1)
        axes.plot(
            *prints.place[of].T,
            MARKERS[tripod],
            color=TRIPODS[tripod],
            markersize=3,
            markeredgewidth=0,
            alpha=0.8,
            label=f"tripod {tripod}, legs {'-'.join(map(str, legs))}",
        )
    axes.plot([], [], color=NOMINAL, linewidth=0.5, label="one leg's, in order")
    as_map(axes, "$l$")
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, 1.02), handletextpad=0.2)


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
    axes.plot(
        [], [], color=WEIGHT, marker=">", markersize=3, label="heading at segment ends"
    )
    as_map(axes, "$l$")
    axes.legend(loc="upper left")
