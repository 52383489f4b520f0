"""Draw what a Lie bracket does: the pictures of docs/method.md.

Example:
    python -m scripts.brackets docs/brackets.svg
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from models import shipped_system
from planner import Flow, line, plan, play, rollout
from scripts.pages import parser_of, picture

LOOPS = (1.0, 0.75, 0.5, 0.25)
SEGMENTS = (1, 2, 4, 8, 16, 32, 64)
FINE = 40  # states along a flow
BLUE, RED, GREY, GREEN = "#2970bf", "#cc453d", "#6c7582", "#128268"


def draw_loops(axes: Any) -> None:
    """Drive, turn, drive back, turn back: smaller loops end nearer the bracket."""
    system = shipped_system("unicycle").system
    for t in LOOPS:
        durations = [("drive", t), ("turn", t), ("drive", -t), ("turn", -t)]
        flows = [Flow(system.bottom, name, duration) for name, duration in durations]
        x, y, _ = play(system, flows, np.zeros(3), FINE).T
        axes.plot(x, y, color=BLUE, linewidth=1)
        axes.plot(x[-1], y[-1], "o", color=RED, markersize=4)
        axes.plot(0, -(t**2), "o", color=GREY, markersize=5, fillstyle="none")
    axes.plot([], [], "o", color=RED, markersize=4, label="end of a loop")
    bracket = "$t^2$ times the bracket"
    axes.plot([], [], "o", color=GREY, markersize=5, fillstyle="none", label=bracket)
    axes.legend(fontsize=7, loc="lower right", frameon=False)
    axes.set(title="A wheel drives and turns", xlabel="x", ylabel="y")
    axes.set_aspect("equal")
    axes.set_ylim(-1.42, 0.08)  # room for the legend


def draw_word(axes: Any) -> None:
    """The body's way while the tripods of the paper's hexapod swing in turn."""
    problem = shipped_system("paper-hexapod")
    a = 0.5
    word = [("1", a), ("2", a), ("1", -a), ("2", -a)]
    flows = [Flow(tripod, f"g{tripod}_{tripod}", t) for tripod, t in word]
    states = play(problem.system, flows, problem.states[0], FINE)
    for k, (tripod, _) in enumerate(word):
        x, y = states[k * FINE : (k + 1) * FINE + 1, :2].T
        axes.plot(x, y, color=BLUE if tripod == "1" else RED, linewidth=1.6)
    axes.plot([], [], color=BLUE, label="tripod 1 swings")
    axes.plot([], [], color=RED, label="tripod 2 swings")
    axes.annotate("", states[-1, :2], (0, 0), arrowprops={"arrowstyle": "->"})
    axes.text(0.03, 0.24, "sideways", color=GREY, fontsize=7)
    axes.legend(fontsize=7, loc="upper right", frameon=False)
    axes.set(title="A hexapod's bracket", xlabel="forward", ylabel="left")
    axes.set(xlim=(-0.15, 1.3), ylim=(-0.1, 0.85))


def draw_errors(axes: Any) -> None:
    """The way of Sec. 6 cut finer and finer: the end's error falls as one over n."""
    problem = shipped_system("paper-hexapod")
    start, goal = problem.states
    way = partial(plan, problem.system, line(start, goal), elements=problem.elements)
    plans = (way(n, execution=problem.execution) for n in SEGMENTS)
    errors = [np.linalg.norm(rollout(planned)[-1] - goal) for planned in plans]
    axes.loglog(SEGMENTS, errors, "o-", c=GREEN, ms=4, label="end of the plan")
    ideal = errors[-1] * SEGMENTS[-1] / np.array(SEGMENTS)
    axes.loglog(SEGMENTS, ideal, "--", c=GREY, label="one over n")
    axes.legend(fontsize=7, loc="upper right", frameon=False)
    axes.set_xticks(SEGMENTS, [str(n) for n in SEGMENTS])
    axes.minorticks_off()
    axes.set(title="Cut finer, it ends nearer", xlabel="segments n")
    axes.set_ylabel("distance from the goal")


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw the three panels into one file."""
    parser = parser_of(__doc__)
    parser.add_argument("file", type=Path, help="picture to write, such as .svg")
    path = parser.parse_args(arguments).file
    look = {"font.size": 8, "svg.hashsalt": "brackets", "svg.fonttype": "path"}
    with picture(path, (7.6, 2.7), look, metadata={"Date": None}) as figure:
        panels = figure.subplots(1, 3)
        for draw, axes in zip(
            (draw_loops, draw_word, draw_errors), panels, strict=True
        ):
            draw(axes)


if __name__ == "__main__":
    main()
