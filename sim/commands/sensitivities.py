"""`stratawalk sensitivities`: what small changes would do to the end of a walk."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.commands.options import option, report

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sim.runs.run import Run

HELP = (
    "what a degree of each zero, a millimetre of each foot and more do to a walk's end"
)
OPTIONS = (
    option("run", metavar="RUN", help="folder of a finished run"),
    option("--out", metavar="FILE.png", help="picture over the robot seen from above"),
)

POSE = ("x", "y", "yaw")


def execute(options: argparse.Namespace) -> None:
    """Print the table, and draw the picture if one is asked for."""
    from sim.folder import blamed_on
    from sim.runs.run import read_run

    folder = Path(options.run)
    with blamed_on(folder):
        run = read_run(folder)
        found = rows(run)
    if options.out is not None:
        draw(run, found, Path(options.out))
    head = f"{'a change by one':38}{'moves the end by x, y [mm]':>28}{'yaw [mrad]':>12}"
    report(options, found, head, *map(_line, found))


def _line(row: dict[str, Any]) -> str:
    x, y, yaw = (1e3 * row[key] for key in POSE)
    return f"{row['unit']:7}{row['what']:31}{x:18.2f}{y:10.2f}{yaw:12.2f}"


def rows(run: Run) -> list[dict[str, Any]]:
    """Changes with their units and what one of them does, `x`, `y` [m], `yaw` [rad]."""
    from sim.studies.sensitivities import sensitivities_of

    found = sensitivities_of(run)
    return [
        {"what": each.what, "unit": each.unit} | dict(zip(POSE, moved, strict=True))
        for each, moved in zip(found.changes, found.pose[:, 0].tolist(), strict=True)
    ]


def draw(run: Run, found: Sequence[dict[str, Any]], path: Path) -> None:
    """Arrows from the feet, as the end moves by a unit of what is changed there."""
    import numpy as np
    from matplotlib.figure import Figure

    from sim import palette

    feet = run.contact_point[0] - run.achieved[0, :2]
    longest = max(float(np.hypot(row["x"], row["y"])) for row in found) or 1.0
    scale = 0.6 * float(np.abs(feet).max()) / longest
    kinds = sorted({_kind(row) for row in found})
    figure = Figure(figsize=(6.0, 6.0), layout="constrained")
    axes = figure.add_subplot(aspect="equal")
    axes.plot(*feet.T, "o", color=palette.OUTLINE.hex)
    for row in found:
        leg = str(row["what"]).rpartition("leg ")[2]
        own = feet[run.legs.index(int(leg))] if leg.isdigit() else np.zeros(2)
        at = float(own[0]), float(own[1])
        tip = at[0] + scale * row["x"], at[1] + scale * row["y"]
        colour = palette.group(kinds.index(_kind(row))).hex
        style = {"arrowstyle": "->", "color": colour}
        axes.annotate("", tip, at, arrowprops=style)
        axes.plot(*tip, alpha=0)
    for number, kind in enumerate(kinds):
        axes.plot([], [], color=palette.group(number).hex, label=kind)
    axes.legend(loc="upper right")
    axes.set_xlabel("x [m], forward")
    axes.set_ylabel("y [m], left")
    axes.set_title(f"where the end moves, {scale:.3g} times as long")
    figure.savefig(path, dpi=120)


def _kind(row: dict[str, Any]) -> str:
    what = str(row["what"]).partition(" of leg")[0]
    return f"a {row['unit']}: {what}"
