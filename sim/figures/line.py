"""Fig. 6: a straight line sideways and forward in ever more segments, and its tube."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from planner import Array
from sim.figures.paper import PaperWalk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Sheet, Table, words
from sim.figures.style import (
    IDEAL,
    MM,
    NOMINAL,
    PATHS,
    PHYSICS,
    QUASI_STATIC,
    WEIGHT,
    as_map,
    draw_walk,
    letter,
    plain_decades,
    sheet_of,
)
from sim.figures.tube import Tube, envelope, exponent, follow, swing_out, tube

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SEGMENTS = (1, 4, 16, 60)  # drawn
TUBE_SEGMENTS = (1, 2, 4, 8, 16, 32, 60, 120, 240)  # measured
SHOWN = (*SEGMENTS, 240)  # on the axis
PAPER_CAPTION = """
Body centre on eqs. (16) to (18), l = 1, from (0, 0, 0) to (1, 1, 0) in 1, 4, 16 and 60
segments; the paper draws four. Within a segment the path swings out of the line by the
strokes of its bracket. (d) shows where: the area between the farthest points of each
segment on both sides of the line. (e) The tube's half width falls as the square root of
the segment's length. Measured power: {power:.3f} from 16 segments on,
{last:.3f} between the last two. (f) The end error falls as one over the number of
segments.
The single segment uses h5 = 5/8, the integral of the paper's own equation, where the
paper prints 3/4.
"""
METRES_CAPTION = """
Body centre of `hexapod` from (0, 0, 0) to (0.03 m, 0.03 m, 0), open loop with lifted
fields: in the physics, predicted on the paper's constant fields (ideal), and on the
contact kinematics of the actual legs (quasi-static). Strokes are centred. (d) shows the
area between the farthest points of each segment on both sides of the line, in which the
two predictions cannot be told apart from the physics. The
line is as long as the joint range of 0.45 rad lets a single segment reach, 0.44 of the
paper's line in units of the pivots' distance. (e) Half width of the tube of the body's
centre; the power is that from 4 to 60 segments. (f) Shorter segments bring the
prediction to the goal, and the physics to the prediction up to 16 of them; with 60, and
eight contact switches in each, the physics is farther off again.
"""
GOAL = (1.0, 1.0, 0.0)
METRES_LENGTH = 0.03 * np.sqrt(2)


def paper() -> Sheet:
    """From (0, 0, 0) to (1, 1, 0) with l = 1, the numbers of Sec. 6."""
    figure, axes = sheet_of("abc\ndef", 4.6)
    for name, segments in zip("abc", SEGMENTS[:-1], strict=True):
        _draw_walk(axes[name], follow(GOAL, segments))
    _draw_envelope(axes["d"], follow(GOAL, SEGMENTS[-1]))
    measured = tube(GOAL, TUBE_SEGMENTS)
    _draw_tube(axes["e"], measured)
    _draw_errors(axes["f"], measured)
    plural = {n: f"{n} segment{'s' * (n > 1)}" for n in SEGMENTS}
    _key_below(figure, axes["a"])
    titles = dict(zip("abcd", plural.values(), strict=True))
    letter(axes, titles | {"e": "half width of the tube", "f": "end error"})
    return Sheet(
        name="fig6-line-paper",
        title="Fig. 6, straight line, in the paper's units",
        caption=words(
            PAPER_CAPTION, power=measured.exponent, last=measured.last_exponent
        ),
        figure=figure,
        table=Table(
            header=(
                "segments",
                "length of one [l]",
                "half width of the tube [l]",
                "largest turn [rad]",
                "end error [l]",
                "end error x segments [l]",
            ),  # fmt: skip
            rows=tuple(
                zip(
                    measured.segments.tolist(),
                    measured.length.tolist(),
                    measured.width.tolist(),
                    measured.turn.tolist(),
                    measured.error.tolist(),
                    (measured.error * measured.segments).tolist(),
                    strict=True,
                )
            ),
        ),
    )


METRES_GOAL = (0.03, 0.03, 0.0)
WALKS = {
    f"line-{n}": Job("line", {"path.goal": METRES_GOAL, "segments": n})
    for n in SEGMENTS
}


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """The longest such line that one segment's strokes reach, in the same segments."""
    figure, axes = sheet_of("abc\ndef", 4.6)
    *coarse, finest = made = [walks[name] for name in WALKS]
    for name, walked in zip("abc", coarse, strict=True):
        _draw_physics(axes[name], walked)
    _draw_bands(axes["d"], finest)
    widths = {name: [_tube(w, name) for w in made] for name in ("ideal", "achieved")}
    length = METRES_LENGTH / np.array(SEGMENTS)
    _draw_widths(axes["e"], length, widths)
    _draw_departures(axes["f"], made)
    plural = [f"{n} segment{'s' * (n > 1)}" for n in SEGMENTS]
    titles = dict(zip("abcd", plural, strict=True))
    _key_below(figure, axes["a"])
    letter(axes, titles | {"e": "half width of the tube", "f": "distance at the end"})
    rows = [_row(n, w) for n, w in zip(SEGMENTS, made, strict=True)]
    return Sheet(
        name="fig6-line-metres",
        title="Fig. 6, straight line, in metres",
        caption=words(METRES_CAPTION),
        figure=figure,
        table=Table(
            header=(
                "segments",
                "half width of the tube, ideal [m]",
                "half width of the tube, physics [m]",
                "physics off ideal [m]",
                "physics off quasi-static [m]",
                "physics off goal [m]",
                "contact switches",
            ),  # fmt: skip
            rows=tuple(rows),
        ),
    )


def _tube(walked: Walked, name: str) -> float:
    points, segment = walked.pose[name][:, :2], walked.segment
    ends = np.append(np.flatnonzero(np.diff(segment)), len(segment) - 1)
    line_produced = np.outer([-1.0, 2.0], METRES_GOAL[:2])
    return float(swing_out(points, ends, line_produced).max())


def _off(walked: Walked, name: str) -> float:
    ends = walked.pose["achieved"][-1], walked.pose[name][-1]
    return float(np.hypot(*(ends[0] - ends[1])[:2]))


def _off_goal(walked: Walked) -> float:
    return float(np.hypot(*(walked.pose["achieved"][-1] - METRES_GOAL)[:2]))


def _row(segments: int, walked: Walked) -> tuple[Cell, ...]:
    return (
        segments,
        _tube(walked, "ideal"),
        _tube(walked, "achieved"),
        _off(walked, "ideal"),
        _off(walked, "quasi_static"),
        _off_goal(walked),
        int(str(walked.summary["contact_switches"])),
    )


def _draw_physics(axes: Axes, walked: Walked) -> None:
    draw_walk(axes, walked)
    as_map(axes, "mm")


def _draw_bands(axes: Axes, walked: Walked) -> None:
    """What the physics swings over, and the rims of both predictions."""
    axes.plot(*(MM * walked.nominal.T), "--", color=NOMINAL, zorder=3)
    segment = walked.segment
    ends = np.append(np.flatnonzero(np.diff(segment)), len(segment) - 1)
    for name, style in PATHS.items():
        points = walked.pose[name][:, :2]
        rims = MM * envelope(points, ends, np.zeros(2), np.array(METRES_GOAL[:2]))
        if name == "achieved":
            _fill_between(axes, rims, str(style["color"]))
            continue
        for rim in rims:
            axes.plot(*rim.T, **dict(style) | {"label": "_"})
    as_map(axes, "mm")
    axes.legend(loc="lower right")


def _fill_between(axes: Axes, rims: Array, colour: str) -> None:
    """Fill between two chains of points, shape (2, N, 2)."""
    outline = np.concatenate([rims[0], rims[1][::-1]])
    label = "between\nfarthest points"
    axes.fill(*outline.T, color=colour, alpha=0.6, linewidth=0, label=label)


def _key_below(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))


def _draw_widths(
    axes: Axes, length: Array, widths: Mapping[str, Sequence[float]]
) -> None:
    for name, colour, marker in (("ideal", IDEAL, "o-"), ("achieved", PHYSICS, "s:")):
        label = "physics" if name == "achieved" else "predicted"
        label += f", power {exponent(length[1:], np.array(widths[name][1:])):.2f}"
        axes.loglog(
            MM * length, MM * np.array(widths[name]), marker,
            color=colour, markersize=3, label=label,
        )  # fmt: skip
    through = widths["ideal"][-1] * np.sqrt(length / length[-1])
    axes.loglog(MM * length, MM * through, "--", color=NOMINAL, label="square root")
    axes.set(xlabel="length of a segment  [mm]", ylabel="half width of the tube  [mm]")
    axes.set_ylim(4, 90)  # room for the legend
    plain_decades(axes.xaxis, axes.yaxis)
    axes.legend(loc="upper left")


def _draw_departures(axes: Axes, made: Sequence[Walked]) -> None:
    off = {
        "goal": ([_off_goal(w) for w in made], NOMINAL, "^--"),
        "ideal": ([_off(w, "ideal") for w in made], IDEAL, "o-"),
        "quasi-static": ([_off(w, "quasi_static") for w in made], QUASI_STATIC, "s-"),
    }
    for name, (distances, colour, marker) in off.items():
        axes.loglog(
            SEGMENTS, MM * np.array(distances), marker,
            color=colour, markersize=3, label=f"physics off {name}",
        )  # fmt: skip
    axes.set(xlabel="number of segments", ylabel="distance at the end  [mm]")
    axes.set_ylim(top=10)  # room for the legend
    plain_decades(axes.yaxis)
    axes.set_xticks(SEGMENTS, map(str, SEGMENTS), minor=False)
    axes.legend(loc="upper right")


def _draw_walk(axes: Axes, walked: PaperWalk) -> None:
    axes.plot([0, GOAL[0]], [0, GOAL[1]], "--", color=NOMINAL, label="nominal")
    axes.plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.8, label="walked")
    ends = walked.states[walked.ends, :2]
    axes.plot(*ends.T, "o", color=WEIGHT, markersize=2, label="ends of segments")
    as_map(axes, "$l$")


def _draw_envelope(axes: Axes, walked: PaperWalk) -> None:
    """What a walk of many segments swings over."""
    rims = envelope(walked.states[:, :2], walked.ends, np.zeros(2), np.array(GOAL[:2]))
    _fill_between(axes, rims, IDEAL)
    axes.plot([0, GOAL[0]], [0, GOAL[1]], "--", color=WEIGHT, linewidth=0.7)
    as_map(axes, "$l$")
    axes.legend(loc="lower right")


def _draw_tube(axes: Axes, measured: Tube) -> None:
    label = f"walked, power {measured.exponent:.2f}"
    axes.loglog(
        measured.length, measured.width, "o-", color=IDEAL, markersize=3, label=label
    )
    fine = measured.length[[0, -1]]
    through = measured.width[-1] * np.sqrt(fine / fine[-1])
    axes.loglog(fine, through, "--", color=NOMINAL, label="square root")
    plain_decades(axes.xaxis, subs=(1,))
    plain_decades(axes.yaxis)
    axes.set_ylim(top=2)  # room for the legend
    axes.set(
        xlabel="length of a segment  [$l$]", ylabel="half width of the tube  [$l$]"
    )
    axes.legend(loc="upper left")


def _draw_errors(axes: Axes, measured: Tube) -> None:
    axes.loglog(
        measured.segments, measured.error, "o-", color=IDEAL, markersize=3,
        label="walked",
    )  # fmt: skip
    through = measured.error[-1] * measured.segments[-1] / measured.segments
    axes.loglog(measured.segments, through, "--", color=NOMINAL, label="one over n")
    axes.set(xlabel="number of segments n", ylabel="distance from the goal  [$l$]")
    plain_decades(axes.yaxis)
    axes.set_xticks(SHOWN, map(str, SHOWN), minor=False)
    axes.legend(loc="upper right")
