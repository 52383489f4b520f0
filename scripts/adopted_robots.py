"""Robots adopted by one command each, and how they walk: docs/adopted-robots.md.

Each robot of `scripts.adoptees` is written to a folder, adopted, and walks sideways and
forward by 0.8 of the mean distance of its feet from the middle.

Example:
    python -m scripts.adopted_robots --out docs/adopted-robots.md
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from models import Kinematics, load
from scripts.adoptees import ADOPTEES, Adoptee
from sim import load_scenario, simulate

FAR = 0.8  # of the mean distance of the feet from the middle
SEGMENTS = 20
PAGE = f"""# Adopted robots

These robots were drawn as others draw them, without a card, and adopted by
`stratawalk adopt FILE` alone; nothing was corrected by hand. Each walks from (0, 0, 0)
to (s, s, 0) in {SEGMENTS} segments, where s is
{FAR} of the mean distance of its feet from the middle. The servos are the robot's own
where it has any, and those that `adopt` drafted otherwise. The last but one column is
the distance between where it ended and where the quasi-static prediction has it, as a
share of the path. The table is written by `python -m scripts.adopted_robots`;
`scripts/adoptees.py` draws the robots.

| robot | file | legs | joints a leg | servos [N m/rad] | s [m] | verdict \
| off the goal | off | bounces |
|---|---|---|---|---|---|---|---|---|---|
"""


def row_of(adoptee: Adoptee, folder: Path) -> str:
    """Adopt one robot, walk it, and report.

    Args:
        adoptee: What to build.
        folder: Where to build it.
    """
    path = adoptee.write(folder)
    adopt = [sys.executable, "-m", "sim.cli", "adopt", str(path)]
    code = subprocess.run(adopt, stdout=subprocess.DEVNULL).returncode
    if code:
        raise SystemExit(f"{adoptee.name} was not adopted: code {code}")
    robot = load(str(path.with_suffix(".xml")))
    far = FAR * Kinematics(robot).reach
    changes: dict[str, object] = {
        "robot": str(robot.path),
        "path.goal": [far, far, 0.0],
        "segments": SEGMENTS,
    }
    summary: Any = simulate(load_scenario("line", changes)).summary
    error, length = summary["error"], summary["path_length"]
    cells = (
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
    return f"| {' | '.join(map(str, cells))} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="page to write")
    parser.add_argument("--only", nargs="+", help="robots to print the rows of")
    options = parser.parse_args(arguments)
    chosen = [a for a in ADOPTEES if options.only is None or a.name in options.only]
    rows = []
    for adoptee in chosen:
        with TemporaryDirectory() as folder:
            rows.append(row_of(adoptee, Path(folder)))
        print(rows[-1], flush=True)
    if options.out is not None and options.only is None:
        options.out.write_text(PAGE + "\n".join([*rows, ""]) + below(options.out))


def below(page: Path) -> str:
    """The sections of a page below its table, which are written by hand."""
    _, heading, rest = (
        page.read_text().partition("\n## ") if page.exists() else ("",) * 3
    )
    return heading + rest


if __name__ == "__main__":
    main()
