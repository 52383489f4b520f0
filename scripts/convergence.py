"""How far the physics departs from its quasi-static prediction, setting by setting.

A turning walk of six segments is repeated with one setting changed at a time; a last
panel of the picture shows which phases the error comes from.

Example:
    python -m scripts.convergence --plot docs/fidelity.png
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from scripts.pages import STUDIES, parser_of, picture, tabulate
from sim import load_scenario, simulate

STUDY = STUDIES["convergence"]
VALUES: Mapping[str, Sequence[float]] = STUDY["values"]
PREDICTION, OFF = "quasi_static", "quasi-static"
COLOUR = "#8022be"  # that this prediction has in all pictures
LENGTHS = "off [mm] | yaw [mrad] | slip [mm] | predicted | end moved [mm]"


def walked(setting: str, value: float) -> Any:
    """Numbers of the study's walk with one setting changed, as in summary.json."""
    changes: dict[str, object] = {setting: value, "path": STUDY["path"], "segments": 6}
    if setting == "swing_speed":
        changes["swing_acceleration"] = 10 * value  # the same way to full speed
    without = ("identified", "compliant", "creep_floor")
    return simulate(load_scenario("line", changes), without=without).summary.to_json()


def share(walk: Any) -> float:
    """Position error of the prediction over the length of the path."""
    return float(walk["error"][PREDICTION]["position"] / walk["path_length"])


def study(setting: str) -> list[Any]:
    """Print one table as it grows."""
    walks = []

    def rows() -> Iterator[tuple[object, ...]]:
        before = np.nan
        for value in VALUES[setting]:
            walks.append(walk := walked(setting, value))
            end = np.array(walk["achieved"]["pose"][:2])
            off, predicted = walk["error"][PREDICTION], walk["predicted"][PREDICTION]
            slips = walk["achieved"]["slip"], predicted["slip"]
            lengths = off["position"], off["yaw"], *slips, np.hypot(*(end - before))
            before = end
            shown = (f"{1e3 * length:.3f}" for length in lengths)
            yield f"{value:g}", f"{share(walk):.3%}", walk["bounces"], *shown

    tabulate(f"{setting} | of path | bounces | {LENGTHS}", rows())
    return walks


def draw(studies: Mapping[str, Sequence[Any]], path: Path) -> None:
    """One panel a setting, and one for the sources of the error at the defaults."""
    most = 120 * max(share(walk) for walks in studies.values() for walk in walks)
    with picture(path, (7.0, 3.6), dpi=300) as figure:
        panels = figure.subplot_mosaic("ABE\nCDE", width_ratios=(1.3, 1.3, 1))
        for letter, (setting, walks) in zip("ABCD", studies.items(), strict=True):
            axes, values = panels[letter], VALUES[setting]
            ratios = [100 * share(walk) for walk in walks]
            axes.semilogx(values, ratios, "o-", color=COLOUR, markersize=3)
            label = f"{setting.replace('_', ' ')} {STUDY['units'][setting]}".rstrip()
            axes.set(xlabel=label, ylabel=f"off {OFF}\n[% of path]", ylim=(0, most))
            axes.set_xticks(values, [f"{value:g}" for value in values])
            axes.minorticks_off()
        found = studies["timestep"][1]["error_sources"][PREDICTION]
        parts = [(*name.split(), np.array(moved[:2])) for name, moved in found.items()]
        kinds = STUDY["kinds"]
        moves = {f"{kinds[k]} {on}": moved for k, on, moved in parts if k in kinds}
        for name, of in STUDY["sums"].items():
            moves[name] = sum(moved for k, _, moved in parts if k in of)
        lengths = [1e3 * np.hypot(*moved) for moved in moves.values()]
        panels["E"].barh([*moves], lengths, color=COLOUR)
        panels["E"].invert_yaxis()
        panels["E"].set(xlabel="shift of the end [mm]", title="sources at the defaults")


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
