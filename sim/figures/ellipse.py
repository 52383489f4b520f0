"""Fig. 7: an ellipse at constant heading in 60 segments."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from planner import Array, ellipse
from sim.figures import style
from sim.figures.paper import by_segment, configuration, swing_out, walk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Shown, rows_of
from sim.figures.style import IDEAL, INK, MM, NOMINAL, PHYSICS, QUASI_STATIC
from sim.palette import Style

SEGMENTS_AROUND = 60
SEMI_AXES = (5.0, 3.0)  # of the shape of the scenario `ellipse`
WALKS = {"ellipse": Job("ellipse", cost=9)}


def paper(axes: Mapping[str, Axes]) -> Shown:
    """Once around with l = 1."""
    path = ellipse(configuration((0, 0, 0)), SEMI_AXES)
    walked = walk(path, SEGMENTS_AROUND)
    nominal = path.at(np.linspace(0, 1, 721))[:, :2]
    widths = swing_out(walked.states[:, :2], walked.ends, nominal)
    headings = by_segment(walked.states[:, 2], walked.ends)
    least, most = np.array([(h.min(), h.max()) for h in headings]).T
    axes["a"].plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.6, label="walked")
    axes["a"].plot(*nominal.T, "--", color=NOMINAL, label="nominal")
    dots: Style = {"color": INK, "markersize": 1.5, "label": "segment ends"}
    axes["a"].plot(*walked.states[walked.ends, :2].T, "o", **dots)
    axes["b"].step(np.arange(1, SEGMENTS_AROUND + 1), widths, where="mid", color=IDEAL)
    axes["b"].set_ylim(bottom=0)
    label = "least to largest"
    style.band(axes["c"], least, most, colour=IDEAL, alpha=0.45, label=label)
    k = _chosen(SEGMENTS_AROUND)
    ends = walked.states[walked.ends][k]
    goals = ellipse(walked.plan.goal, SEMI_AXES).at((k + 1) / SEGMENTS_AROUND)
    off = np.hypot(*(ends - goals)[:, :2].T)
    rows = rows_of(k + 1, *ends[:, :3].T, off, widths[k], least[k], most[k])
    return Shown(rows, {"a": SEMI_AXES[0], "b": SEMI_AXES[1]})


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """The scenario `ellipse` in the physics."""
    walked = walks["ellipse"]
    style.draw_walk(axes["a"], walked)
    off = []
    for name, colour in (("ideal", IDEAL), ("quasi_static", QUASI_STATIC)):
        apart = walked.pose["achieved"] - walked.pose[name]
        off.append(np.hypot(*apart[:, :2].T))  # at every row
        spread = style.extremes(MM * off[-1], walked.segment)
        label = f"off {name.replace('_', '-')}"
        style.band(axes["b"], *spread, colour=colour, alpha=0.55, label=label)
    k = _chosen(walked.summary.segments)
    margins, segment = {}, np.arange(1, walked.summary.segments + 1)
    looks = ("achieved", "physics", "o", PHYSICS), ("ideal", "predicted", "-", IDEAL)
    for name, label, fmt, colour in looks:
        margin, _ = style.extremes(walked.margin[name], walked.segment)
        margins[name] = margin[k]
        dots: Style = {"color": colour, "markersize": 2.5, "label": label}
        axes["c"].plot(segment, MM * margin, fmt, **dots)
    last = walked.ends[k]
    columns = *(o[last] for o in off), margins["ideal"], margins["achieved"]
    return Shown(rows_of(k + 1, *walked.pose["achieved"][last].T, *columns))


def _chosen(segments: int) -> Array:
    """Segments in the table, from 0, evenly spread."""
    return np.linspace(0, segments, 13).round().astype(int)[1:] - 1
