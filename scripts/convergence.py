"""How far the physics departs from its quasi-static prediction, setting by setting.

A turning walk of six segments is repeated with one setting changed at a time; a last
panel of the picture shows which phases the error comes from.

Example:
    python -m scripts.convergence --plot docs/fidelity.png
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from scripts.pages import parser_of, picture, tabulate
from sim import error_sources, load_scenario, simulate

PATH = {"kind": "line", "goal": [0.03, 0.03, 0.314]}
VALUES: Mapping[str, tuple[str, Sequence[float]]] = {  # units, and what is tried
    "timestep": ("[s]", (0.002, 0.001, 0.0005, 0.00025)),
    "swing_speed": ("[rad/s]", (0.25, 0.5, 1.0, 1.5, 3.0, 6.0)),
    "servo_stiffness": ("[N m/rad]", (50.0, 100.0, 300.0, 1000.0, 3000.0)),
    "friction": ("", (0.3, 0.6, 0.9, 1.2)),
}
HEADER = "off [mm] | of path [%] | yaw [mrad] | slip [mm] | predicted | bounces"


class Result(NamedTuple):
    """One walk against its quasi-static prediction."""

    value: float
    pose: np.ndarray  # achieved at the end, (3,)
    ratio: float  # position error over the length of the path
    bounces: int
    sources: Mapping[str, Sequence[float]]
    cells: tuple[str, ...]  # of its row, under `HEADER`


def judged(setting: str, value: float) -> Result:
    """Walk the study's path with one setting changed."""
    changes: dict[str, object] = {setting: value, "path": PATH, "segments": 6}
    if setting == "swing_speed":
        changes["swing_acceleration"] = 10 * value  # the same way to full speed
    scenario = load_scenario("line", changes)
    result = simulate(scenario).evaluation
    predicted, pose = result.predicted["quasi_static"], result.achieved.pose[-1]
    *way, yaw = 1e3 * (pose - predicted.pose[-1])
    off, bounces = float(np.hypot(*way)), result.walk.recording.bounces
    ratio = off / 1e3 / scenario.path.length
    slips = (1e3 * slip[-1].sum() for slip in (result.achieved.slip, predicted.slip))
    cells = f"{off:.3f}", f"{ratio:.3%}", f"{yaw:.3f}", *(f"{s:.1f}" for s in slips)
    sources = error_sources(result.walk, result.achieved.pose, predicted)
    return Result(value, pose, ratio, bounces, sources, (*cells, str(bounces)))


def study(setting: str) -> list[Result]:
    """Print one table as it grows."""
    results: list[Result] = []

    def rows() -> Iterator[tuple[object, ...]]:
        for value in VALUES[setting][1]:
            new = judged(setting, value)
            moved = np.hypot(*(new.pose - results[-1].pose)[:2]) if results else np.nan
            results.append(new)
            yield f"{value:g}", *new.cells, f"{1e3 * moved:.3f}"

    tabulate(f"{setting} | {HEADER} | end moved [mm]", rows())
    return results


def draw(studies: Mapping[str, Sequence[Result]], path: Path) -> None:
    """One panel a setting, and one for the sources of the error at the defaults."""
    with picture(path, (7.0, 3.6), dpi=300) as figure:
        panels = figure.subplot_mosaic("ABE\nCDE")
        for letter, (setting, results) in zip("ABCD", studies.items(), strict=True):
            axes = panels[letter]
            values = [result.value for result in results]
            ratios = [100 * result.ratio for result in results]
            axes.semilogx(values, ratios, "o-", color="C0", markersize=3)
            label = f"{setting.replace('_', ' ')} {VALUES[setting][0]}".rstrip()
            axes.set(xlabel=label, ylabel="off [% of path]")
            axes.set_xticks(values, [f"{value:g}" for value in values])
            axes.minorticks_off()
            axes.set_ylim(0, 1.2 * max(ratios))
        at_defaults = studies["timestep"][2].sources
        names = [name for name in at_defaults if not name.startswith("hold")]
        lengths = [1e3 * np.hypot(*at_defaults[name][:2]) for name in names]
        panels["E"].barh(names, lengths, color="C0")
        panels["E"].set(xlabel="shift of the end [mm]", title="where it comes from")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the tables, and draw them where asked to."""
    parser = parser_of(__doc__)
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw it as well")
    plot = parser.parse_args(arguments).plot
    studies = {setting: study(setting) for setting in VALUES}
    if plot is not None:
        draw(studies, plot)


if __name__ == "__main__":
    main()
