"""Fig. 4: the sequence of flows of eq. (12), from stratum to stratum and back."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from mpl_toolkits.mplot3d import Axes3D

from models import shipped_system
from planner import Array, Flow, play
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Shown
from sim.figures.strata import draw_sheets, draw_way, numbered
from sim.figures.style import INK, LEGS, MM, PATHS, STRATA, TRIPODS
from sim.palette import Style

STROKES = (0.8, 0.5)  # [rad], of foot 1 on S1 and of foot 2 on S2
SEQUENCE = (  # lift a foot, turn about the other, set it down
    Flow("1", "g1_3", 1.0), Flow("1", "g1_1", STROKES[0]), Flow("1", "g1_3", -1.0),
    Flow("2", "g2_3", 1.0), Flow("2", "g2_2", STROKES[1]), Flow("2", "g2_3", -1.0),
)  # fmt: skip
REORDERED = tuple(SEQUENCE[i] for i in (1, 0, 2, 4, 3, 5))
"""Eq. (14): lifts commute with strokes (13), so each is undone by the next flow."""
STATES = 20  # of a flow
BARS = -0.5  # [rad], where contacts are drawn
LOADED = {"1": 0.8, "2": 0.5}  # stroke of each tripod [rad]
WALKED = (  # each swings back in the air before, so that its stroke is centred
    Flow("2", "g2_1", -LOADED["1"] / 2), Flow("1", "g1_2", -LOADED["2"] / 2),
    Flow("1", "g1_1", LOADED["1"]), Flow("2", "g2_2", LOADED["2"]),
)  # fmt: skip
WALKS = {"sequence": Job("line", {"segments": 1}, flows=WALKED)}


def paper(axes: Mapping[str, Axes]) -> Shown:
    """On the biped, with l = 1."""
    system = shipped_system("biped").system
    start = np.zeros(system.dimension)
    states = play(system, SEQUENCE, start, STATES)
    strokes = [flow for flow in SEQUENCE if not flow.field.endswith("3")]
    ends = [play(system, flows, start)[-1] for flows in (REORDERED, strokes)]
    apart = max(np.abs(end - states[-1]).max() for end in ends)
    _draw_space(axes["a"], states)
    flow = np.arange(len(states)) / STATES
    for foot in (1, 2):  # the last two coordinates are their heights
        line: Style = {"color": TRIPODS[str(foot)], "label": f"$h_{foot}$, foot {foot}"}
        axes["b"].plot(flow, states[:, foot - 3], **line)
    for i, (name, style) in enumerate((("x", "-"), ("y", "--"), (r"$\theta$", ":"))):
        axes["c"].plot(flow, states[:, i], style, color=INK, label=name)
    for name in "bc":
        for number, step in enumerate(SEQUENCE):
            shade: Style = {"color": STRATA[step.stratum], "alpha": 0.08, "lw": 0}
            axes[name].axvspan(number, number + 1, **shade)
        axes[name].set_xticks(np.arange(len(SEQUENCE)) + 0.5, list("123456"))
        low, high = axes[name].get_ylim()
        axes[name].set_ylim(low, high + 0.35 * (high - low))  # room for the key
    rows: list[tuple[Cell, ...]] = [(0, "S12", "start", 0.0, *states[0].tolist())]
    for number, step in enumerate(SEQUENCE, start=1):
        facts = number, f"S{step.stratum}", step.field, step.duration
        rows.append((*facts, *states[number * STATES].tolist()))
    return Shown(rows, {"a": STROKES[0], "b": STROKES[1], "apart": apart})


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """By the hexapod in the physics."""
    walked = walks["sequence"]
    _draw_angles(axes["a"], walked)
    for name, style in PATHS.items():
        axes["b"].plot(*(MM * walked.pose[name][:, :2].T), **style)
        axes["c"].plot(walked.time, walked.pose[name][:, 2], **style)
    rows: list[tuple[Cell, ...]] = []
    for group, tripod in enumerate(LEGS):
        on = np.flatnonzero(walked.moving == group)
        for name in ("ideal", "quasi_static", "achieved"):
            first, last = walked.pose[name][[on[0], on[-1]]]
            stroke = (f"S{tripod}", name.replace("_", "-"), LOADED[tripod])
            rows.append((*stroke, *(last - first).tolist()))
    return Shown(rows, {"a": LOADED["1"], "b": LOADED["2"]})


def _draw_space(axes: Axes3D, states: Array) -> None:
    heading, heights = states[:, 2], states[:, -2:]
    draw_sheets(axes, (heading.min() - 0.15, heading.max() + 0.15))
    points = np.column_stack([heading, heights])
    draw_way(axes, points, [f.stratum for f in SEQUENCE for _ in range(STATES)])
    for number in range(len(SEQUENCE)):
        at = points[number * STATES + STATES // 2]
        axes.text(*at, str(number + 1), **numbered(STRATA[SEQUENCE[number].stratum]))
    for at, name in ((points[0], "$x_0$"), (points[-1], "$x_f$")):
        axes.plot(*at, "o", color=INK, markersize=3)
        axes.text(*(at + [-0.02, 0.0, 0.04]), name, va="bottom", ha="right")
    axes.set_xticks((0.0, 0.4, 0.8))
    axes.set_xlabel(r"heading $\theta$  [rad]", labelpad=-6)


def _draw_angles(axes: Axes, walked: Walked) -> None:
    for group, (tripod, legs) in enumerate(LEGS.items()):
        colour = TRIPODS[tripod]
        swing, label = walked.swing[:, group], f"tripod {tripod}"
        axes.plot(walked.time, swing, color=colour, label=label)
        for kind, width, alpha in (("achieved", 5, 0.3), ("planned", 1.5, 1.0)):
            on = walked.contact[kind][:, np.array(legs) - 1].all(axis=1)
            level = np.where(on, BARS - 0.1 * group, np.nan)
            bar: Style = {"linewidth": width, "alpha": alpha, "solid_capstyle": "butt"}
            axes.plot(walked.time, level, color=colour, **bar)
    area: Style = {"color": INK, "alpha": 0.06, "linewidth": 0}
    area |= {"transform": axes.get_xaxis_transform(), "label": "neither swings loaded"}
    axes.fill_between(walked.time, 0, 1, where=walked.moving < 0, **area)
    axes.set_ylim(-0.75, 0.6)  # room for words and key
    on_ground: Style = {"color": INK, "fontsize": 7, "ha": "right", "va": "top"}
    axes.text(walked.time[-1], BARS - 0.13, "on the ground", **on_ground)
    axes.set_yticks(np.arange(-0.4, 0.5, 0.2))
