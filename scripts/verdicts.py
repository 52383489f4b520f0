"""A collection of walks, each with its verdict and the code that `run` ends with.

Every shipped scenario walks on every shipped robot, and `line` on adopted ones, draws
of hobby robots, and with one imperfection at a time. Nothing hopeless may end with 0.

Example:
    python -m scripts.verdicts --segments 10 --only "zeros of swing"
"""

import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from math import radians
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from models import Kinematics, load, shipped_robots
from scripts.adoptees import ADOPTEES
from scripts.pages import STUDIES, parser_of, tabulate
from sim import load_scenario, shipped_scenarios, simulate

WITHOUT = ("identified", "creep_floor")  # each costs experiments of its own
TOLERANCE, BROKEN = 0.25, ("fell", "collided")
FAR = 0.8  # of the mean distance of the feet from the middle
SHORT = {"path.goal": [0.03, 0.03, 0.0]}  # 8 segments of `line` as it is
DRAWS, LEGS = 20, 6
SIZES: Mapping[str, Sequence[object]] = STUDIES["imperfections"]
Walk = tuple[str, str, dict[str, object]]  # its name, a scenario, settings


def walks(folder: Path, segments: int, only: str) -> Iterator[Walk]:
    """All walks; of the robots, those with a text in their names are adopted."""
    few: dict[str, object] = {"segments": segments}
    for robot in shipped_robots():
        for scenario in shipped_scenarios():
            yield f"{scenario} on {robot}", scenario, {**few, "robot": robot}
    for adoptee in (one for one in ADOPTEES if only in f"line on {one.name}"):
        path = adoptee.write(folder)
        adopt = [sys.executable, "-m", "sim.cli", "adopt", str(path)]
        subprocess.run(adopt, stdout=subprocess.DEVNULL, check=True)
        robot = str(path.with_suffix(".xml"))
        far = FAR * Kinematics(load(robot)).reach
        changes = {"robot": robot, "path.goal": [far, far, 0.0]}
        yield f"line on {adoptee.name}", "line", {**few, **changes}
    short = {**SHORT, "segments": min(segments, 8)}
    for draw in range(DRAWS):
        yield f"hobby {draw}", "line", {**short, "imperfect": "hobby", "draw": draw}
    for draw in range(3):
        off = np.random.default_rng(draw).uniform(-1, 1, (LEGS, 2)) * radians(1)
        for kind, moved in {"swing": (1, 0), "lift": (0, 1)}.items():
            zeros = (off * moved).ravel().tolist()
            yield f"zeros of {kind} {draw}", "line", {**short, "zero_offset": zeros}
    for setting, sizes in SIZES.items():
        for size in sizes:
            yield f"{setting} {size}", "line", {**short, setting: size}


def row_of(walk: Walk) -> tuple[object, ...]:
    """Walk it, and say how that ends."""
    name, scenario, changes = walk
    try:
        found = simulate(load_scenario(scenario, changes), without=WITHOUT).summary
    except Exception as error:  # a refusal is an ending, too
        return (name, "refused", "", "", "", str(error)[:120])
    weighed = found.weighed
    off = (f"{100 * share:.1f} %" for share in (weighed.goal, weighed.farthest))
    code = 4 if found.verdict in BROKEN else 7 if weighed.beyond(TOLERANCE) else 0
    *_, cause = found.verdict_text.split("; it ended ")
    return (name, found.verdict, code, *off, cause.partition("; ")[2])


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a row for each walk."""
    parser = parser_of(__doc__)
    parser.add_argument("--segments", type=int, default=40, help="of every walk")
    parser.add_argument("--only", default="", help="part of the names of walks")
    options = parser.parse_args(arguments)
    header = "walk | verdict | ends with | off its goal | off its prediction | cause"
    with TemporaryDirectory() as folder:
        found = walks(Path(folder), options.segments, options.only)
        tabulate(header, (row_of(walk) for walk in found if options.only in walk[0]))


if __name__ == "__main__":
    main()
