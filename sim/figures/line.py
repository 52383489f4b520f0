"""Fig. 6: a straight line sideways and forward in ever more segments, and its tube."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from planner import Array
from sim.figures import style
from sim.figures.paper import PaperWalk, envelope, exponent, follow, swing_out, tube
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Shown, rows_of
from sim.figures.style import IDEAL, INK, MM, NOMINAL, PATHS, PHYSICS, QUASI_STATIC
from sim.palette import Style

SEGMENTS = (1, 4, 16, 60)  # drawn
TUBE_SEGMENTS = (1, 2, 4, 8, 16, 32, 60, 120, 240)  # measured
GOAL = (1.0, 1.0, 0.0)
FINER = len(TUBE_SEGMENTS) // 2  # from which on their power is that of the limit
METRES = (0.03, 0.03, 0.0)
WALKS = {
    f"line-{n}": Job("line", {"path.goal": METRES, "segments": n}, cost=0.6 + n / 10)
    for n in SEGMENTS
}


def paper(axes: Mapping[str, Axes]) -> Shown:
    """From (0, 0, 0) to (1, 1, 0) with l = 1, the numbers of Sec. 6."""
    *coarse, finest = (follow(GOAL, n) for n in SEGMENTS)
    for panel, walked in zip("abc", coarse, strict=True):
        _draw_walk(axes[panel], walked)
    _fill_between(axes["d"], envelope(finest.states[:, :2], finest.ends, GOAL), IDEAL)
    measured = tube(GOAL, TUBE_SEGMENTS)
    n, error, width = measured.segments, measured.error, measured.width
    power, last = (exponent(measured.length[k:], width[k:]) for k in (FINER, -2))
    walked_to = f"walked, power {power:.2f}"
    axes["e"].loglog(measured.length, width, "o-", label=walked_to, **_dots(IDEAL))
    axes["f"].loglog(n, error, "o-", label="walked", **_dots(IDEAL))
    axes["f"].loglog(n, error[-1] * n[-1] / n, "--", color=NOMINAL, label="one over n")
    _finish(axes, (*SEGMENTS, TUBE_SEGMENTS[-1]), measured.length, width[-1])
    style.plain_decades(axes["e"].xaxis, subs=(1,))
    axes["e"].set_ylim(top=2)  # room for the legend
    return Shown(
        rows_of(n, measured.length, width, measured.turn, error, error * n),
        {"power": power, "last": last},
    )


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """The longest such line that one segment's strokes reach, in the same segments."""
    *coarse, finest = made = [walks[name] for name in WALKS]
    for panel, walked in zip("abc", coarse, strict=True):
        style.draw_walk(axes[panel], walked)
    # What the physics swings over, and the rims of both predictions.
    axes["d"].plot(*(MM * finest.nominal.T), "--", color=NOMINAL, zorder=3)
    for name, look in PATHS.items():
        rims = MM * envelope(finest.pose[name][:, :2], finest.ends, METRES)
        if name == "achieved":
            _fill_between(axes["d"], rims, look["color"])
        for rim in rims if name != "achieved" else ():
            axes["d"].plot(*rim.T, **{**look, "label": "_"})
    produced = np.outer([-1.0, 2.0], METRES[:2])  # the line, beyond its ends
    widths = {
        n: np.array([swing_out(w.pose[n][:, :2], w.ends, produced).max() for w in made])
        for n in ("ideal", "achieved")
    }
    length = MM * (METRES[0] * np.sqrt(2)) / np.array(SEGMENTS)
    for name, label, fmt, colour in (
        ("ideal", "predicted", "o-", IDEAL),
        ("achieved", "physics", "s:", PHYSICS),
    ):
        label += f", power {exponent(length[1:], widths[name][1:]):.2f}"
        axes["e"].loglog(length, MM * widths[name], fmt, label=label, **_dots(colour))
    off, at_end = [], {n: np.array([w.pose[n][-1] for w in made]) for n in PATHS}
    for name, there, fmt, colour in (
        ("goal", METRES, "^--", NOMINAL),
        ("ideal", at_end["ideal"], "o-", IDEAL),
        ("quasi-static", at_end["quasi_static"], "s-", QUASI_STATIC),
    ):
        off.append(np.hypot(*(at_end["achieved"] - there).T[:2]))
        look = {"label": f"physics off {name}", **_dots(colour)}
        axes["f"].loglog(SEGMENTS, MM * off[-1], fmt, **look)
    axes["f"].set_ylim(top=10)  # room for the legend
    _finish(axes, SEGMENTS, length, MM * widths["ideal"][-1])
    style.plain_decades(axes["e"].xaxis)
    switches = [walked.summary.contact_switches for walked in made]
    return Shown(rows_of(SEGMENTS, *widths.values(), *off[1:], off[0], switches))


def _draw_walk(axes: Axes, walked: PaperWalk) -> None:
    axes.plot([0, GOAL[0]], [0, GOAL[1]], "--", color=NOMINAL, label="nominal")
    axes.plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.8, label="walked")
    ends = walked.states[walked.ends, :2]
    axes.plot(*ends.T, "o", color=INK, markersize=2, label="ends of segments")


def _fill_between(axes: Axes, rims: Array, colour: str) -> None:
    outline = np.concatenate([rims[0], rims[1][::-1]])
    label = "between\nfarthest points"
    axes.fill(*outline.T, color=colour, alpha=0.6, linewidth=0, label=label)


def _finish(
    axes: Mapping[str, Axes], segments: Sequence[int], length: Array, finest: float
) -> None:
    """The square root of the length, through the finest half width; and the scales."""
    ends = length[[0, -1]]
    through = finest * np.sqrt(ends / ends[-1])
    axes["e"].loglog(ends, through, "--", color=NOMINAL, label="square root")
    style.plain_decades(axes["e"].yaxis, axes["f"].yaxis)
    axes["f"].set_xticks(segments, map(str, segments), minor=False)


def _dots(colour: str) -> Style:
    return {"color": colour, "markersize": 3.0}
