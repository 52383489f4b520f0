"""How much time a walk takes, and how far it deviates from its path: what is possible.

Compared by their predicted motion are the paper's printed words and the shortest ones,
in more and fewer segments, and optimised plans that may deviate as far as the printed
plan does, and twice as far; beside a lower bound on the time of any such walk.

Example:
    python -m scripts.short_walks --plot docs/short-walks.png
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scripts.pages import STUDIES, parser_of, picture
from sim import Judge, ScenarioProblem, least_time, load_scenario, prepare

SEGMENTS: Mapping[str, Sequence[int]] = STUDIES["short_walks"]["segments"]
LOOKS: Mapping[str, Sequence[str]] = STUDIES["short_walks"]["looks"]
WIDER = (1.0, 2.0)  # tolerances of optimised plans, in deviations of the printed plan
HEADER = f"{'scenario':10}{'plan':22}{'time [s]':>9}{'deviation [mm]':>16}{'[rad]':>8}"


@dataclass(frozen=True, slots=True)
class Point:
    """One plan: how it is planned, its time [s], the farthest from path and yaw."""

    way: str
    seconds: float
    position: float  # [m]
    yaw: float  # [rad]


def study(name: str) -> list[Point]:
    """Print the plans of a scenario as they are found."""
    points: list[Point] = []

    def add(way: str, detail: str, changes: Mapping[str, object]) -> Point:
        setup = prepare(load_scenario(name, dict(changes)))
        plan, judge = ScenarioProblem(setup).solve().plan, Judge(setup)
        off, seconds = judge.deviation(plan), judge.duration(plan.flows)
        points.append(Point(way, seconds, off.position, off.yaw))
        print(
            f"{name:10}{f'{way}, {detail}':22}{seconds:9.1f}"
            f"{1e3 * off.position:16.1f}{off.yaw:8.3f}",
            flush=True,
        )
        return points[-1]

    for words in ("printed", "shortest"):
        for count in SEGMENTS[name]:
            add(words, str(count), {"words": words, "segments": count})
    own = add("printed", "as shipped", {})
    for wider in WIDER:
        far, turned = wider * own.position, wider * own.yaw
        within = {"path_tolerance": far, "yaw_tolerance": turned, "optimise": "time"}
        add("optimised", f"{wider:g} times", within)
    return points


def draw(studies: Mapping[str, Sequence[Point]], path: Path) -> None:
    """One panel a scenario, time against deviation."""
    with picture(path, (7.0, 2.6), dpi=160) as figure:
        panels = figure.subplots(1, len(studies), squeeze=False)[0]
        for axes, (name, points) in zip(panels, studies.items(), strict=True):
            for way, (style, colour) in LOOKS.items():
                own = (p for p in points if p.way == way)
                on = sorted((1e3 * p.position, p.seconds) for p in own)
                x, y = zip(*on, strict=True)
                what = "optimised plan" if way == "optimised" else f"{way} words"
                axes.plot(x, y, style, color=colour, label=what, markersize=3)
            setup = prepare(load_scenario(name))
            off = np.linspace(0.0, max(p.position for p in points), 5)[1:]
            turned = max(p.yaw for p in points)
            least = [least_time(setup, far, turned) for far in off.tolist()]
            axes.plot(1e3 * off, least, ":", color="#940b31", label="lower bound")
            axes.set(title=name, xlabel="farthest from the path [mm]")
            axes.set(xlim=(0, None), ylim=(0, None))
        panels[0].set_ylabel("time of the walk [s]")
        key = panels[0].get_legend_handles_labels()
        figure.legend(*key, loc="outside lower center", ncols=len(key[0]))


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the plans, and draw them where asked to."""
    parser = parser_of(__doc__)
    parser.add_argument("scenarios", nargs="*", metavar="SCENARIO", default=[*SEGMENTS])
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw it as well")
    options = parser.parse_args(arguments)
    print(HEADER)
    studies = {name: study(name) for name in options.scenarios}
    if options.plot is not None:
        draw(studies, options.plot)


if __name__ == "__main__":
    main()
