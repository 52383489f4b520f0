"""How much time a walk takes, and how far it strays from its path: what is to be had.

Three ways to plan each scenario are compared by their predicted motion: the paper's
printed words and the shortest words, in more and fewer segments, and optimised plans
that may stray as far as the printed plan does, and twice as far. Nothing is walked in
the physics. A plan is better than another where it is lower and farther to the left.
The dotted line is a lower bound on the time of any walk that strays as far.

Example:
    python -m scripts.short_walks --plot docs/short-walks.png
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim import Judge, ScenarioProblem, least_time, load_scenario, prepare

SCENARIOS = ("line", "ellipse", "diagonal")
SEGMENTS: Mapping[str, Sequence[int]] = {
    "line": (20, 30, 40, 60, 80),
    "ellipse": (30, 45, 60, 90, 120),
    "diagonal": (15, 22, 30, 45, 60),
}
WIDER = (1.0, 2.0)  # tolerances of optimised plans, in deviations of the printed plan
HEADER = f"{'scenario':10}{'plan':22}{'time [s]':>9}{'strays [mm]':>13}{'[rad]':>8}"


@dataclass(frozen=True, slots=True)
class Point:
    """One plan."""

    scenario: str
    way: str  # of planning
    detail: str
    seconds: float
    position: float  # farthest from the path [m]
    yaw: float  # farthest from the yaw of the path [rad]

    def __str__(self) -> str:
        return (
            f"{self.scenario:10}{f'{self.way}, {self.detail}':22}{self.seconds:9.1f}"
            f"{1e3 * self.position:13.1f}{self.yaw:8.3f}"
        )


def planned(name: str, way: str, detail: str, changes: Mapping[str, object]) -> Point:
    """Plan a scenario with some of its settings changed.

    Args:
        name: Name of the scenario.
        way: How it is planned.
        detail: What distinguishes plans of the same way.
        changes: Settings.
    """
    setup = prepare(load_scenario(name, dict(changes)))
    plan, judge = ScenarioProblem(setup).solve().plan, Judge(setup)
    off, seconds = judge.deviation(plan), judge.duration(plan.flows)
    return Point(name, way, detail, seconds, off.position, off.yaw)


def study(name: str) -> list[Point]:
    """Print the plans of a scenario as they are found."""
    points: list[Point] = []

    def add(way: str, detail: str, changes: Mapping[str, object]) -> Point:
        points.append(planned(name, way, detail, changes))
        print(points[-1], flush=True)
        return points[-1]

    for words in ("printed", "shortest"):
        for count in SEGMENTS[name]:
            add(words, str(count), {"words": words, "segments": count})
    own = add("printed", "as shipped", {})
    for wider in WIDER:
        within = {
            "path_tolerance": wider * own.position,
            "yaw_tolerance": wider * own.yaw,
        }
        add("optimised", f"{wider:g} times", within | {"optimise": "time"})
    return points


def draw(studies: Mapping[str, Sequence[Point]], path: Path) -> None:
    """One panel a scenario, time against deviation."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from scripts.convergence import LOOK

    styles = {
        "printed": ("#0072B2", "o-"),
        "shortest": ("#009E73", "s--"),
        "optimised": ("#D55E00", "D-"),
    }
    with mpl.rc_context(LOOK):
        figure = Figure(figsize=(7.0, 2.4), layout="constrained")
        panels = figure.subplots(1, len(studies), squeeze=False)[0]
        for axes, (name, points) in zip(panels, studies.items(), strict=True):
            for way, (colour, style) in styles.items():
                on = sorted(
                    (1e3 * p.position, p.seconds) for p in points if p.way == way
                )
                x, y = zip(*on, strict=True)
                axes.plot(x, y, style, color=colour, label=way, markersize=3)
            axes.plot(*_bound(name, points), ":", color="0.4", label="lower bound")
            axes.set(title=name, xlabel="farthest from the path [mm]")
            axes.set(xlim=(0, None), ylim=(0, None))
        panels[0].set_ylabel("time [s]")
        panels[1].legend()
        figure.savefig(path, dpi=160)


def _bound(name: str, points: Sequence[Point]) -> tuple[list[float], list[float]]:
    """Deviations [mm], and the least time that walks with them take [s]."""
    setup = prepare(load_scenario(name))
    strays = np.linspace(0.0, max(p.position for p in points), 15).tolist()
    return [1e3 * s for s in strays], [least_time(setup, s) for s in strays]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the plans, and draw them where asked to."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("scenarios", nargs="*", metavar="SCENARIO", default=SCENARIOS)
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw it as well")
    options = parser.parse_args(arguments)
    print(HEADER)
    studies = {name: study(name) for name in options.scenarios}
    if options.plot is not None:
        draw(studies, options.plot)
        print(f"drawn: {options.plot}")


if __name__ == "__main__":
    main()
