"""Robots adopted by one command each, and how they walk: docs/adopted-robots.md.

Each robot of `scripts.adoptees` is written to a folder, adopted, and walks sideways and
forward by 0.8 of the mean distance of its feet from the middle.

Example:
    python -m scripts.adopted_robots --out docs/adopted-robots.md
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from models import Kinematics, load
from scripts.adoptees import ADOPTEES, Adoptee
from scripts.pages import parser_of, tabulate
from sim import load_scenario, simulate

FAR = 0.8  # of the mean distance of the feet from the middle
SEGMENTS = 20
HEADER = (
    "robot | file | legs | joints a leg | servos [N m/rad] | s [m] | verdict | "
    "off the goal | off | bounces"
)


def row_of(adoptee: Adoptee) -> tuple[object, ...]:
    """Adopt one robot, and walk it."""
    with TemporaryDirectory() as folder:
        path = adoptee.write(Path(folder))
        adopt = [sys.executable, "-m", "sim.cli", "adopt", str(path)]
        subprocess.run(adopt, stdout=subprocess.DEVNULL, check=True)
        robot = load(str(path.with_suffix(".xml")))
        far = FAR * Kinematics(robot).reach
        changes: dict[str, object] = {
            "robot": str(robot.path),
            "path.goal": [far, far, 0.0],
            "segments": SEGMENTS,
        }
        summary: Any = simulate(load_scenario("line", changes)).summary
    error, length = summary["error"], summary["path_length"]
    return (
        adoptee.name,
        "URDF" if adoptee.urdf else "MJCF",
        len(adoptee.hips),
        adoptee.joints,
        f"{summary['servo']['stiffness']:.0f}",
        f"{far:.3f}",
        summary["verdict"],
        f"{1e3 * error['goal']['position']:.2f} mm",
        f"{100 * error['quasi_static']['position'] / length:.2f} %",
        summary["bounces"],
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table, or put it in the place of the one in a page."""
    parser = parser_of(__doc__)
    parser.add_argument("--out", type=Path, help="page whose table to write")
    parser.add_argument("--only", nargs="+", help="robots to print the rows of")
    options = parser.parse_args(arguments)
    chosen = [a for a in ADOPTEES if options.only is None or a.name in options.only]
    tabulate(HEADER, map(row_of, chosen), None if options.only else options.out)


if __name__ == "__main__":
    main()
