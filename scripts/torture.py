#!/usr/bin/env python3
"""Run the command on inputs and faults that break programs, and write docs/faults.md.

`python -m scripts.torture` runs the real command for every row, in a folder of its own;
a row that does not end as it must is marked, and the script ends with 1.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ROBOTS = ROOT / "models" / "robots"
HEAD = """# Inputs and faults

What the command does about inputs and surroundings that break programs. This table is
written by `python -m scripts.torture`, which runs every row.

| input or fault | command | code | what it says |
|---|---|---|---|
"""
GO = "--no-video --segments 1 --set path.goal=[0.005,0,0]"
BOMB = '<replicate count="300000"><geom size="1" pos="0 0 9"/></replicate>'


@dataclass(frozen=True)
class Row:
    """One fault: the command, how it must end, and what makes it."""

    fault: str
    command: str
    code: int
    make: Callable[[Path], object] = lambda folder: None


def file(name: str, text: str) -> Callable[[Path], object]:
    """Make a file of this text."""
    return lambda folder: (folder / name).write_text(text)


def robot(old: str, new: str) -> Callable[[Path], object]:
    """Make the shipped hexapod with a text replaced."""

    def make(folder: Path) -> None:
        for name in ("hexapod.xml", "hexapod.toml", "scene.xml"):
            text = (ROBOTS / name).read_text().replace(old, new)
            (folder / name.replace("hexapod", "mine")).write_text(text)

    return make


def world(more: str) -> Callable[[Path], object]:
    """Make the shipped hexapod with something more in its world."""
    return robot("<keyframe>", f"{more}<keyframe>")


def inside(more: str) -> Callable[[Path], object]:
    """Make the shipped hexapod with something more on its floor."""
    return robot("<worldbody>", f"<worldbody>{more}")


SMALL = '<size memory="20K"/>'
WILD = "--set timestep=0.01 --set servo_stiffness=1e6 --set servo_damping=0"
ROWS = (
    Row("a scenario that is missing", "run gone.toml", 2),
    Row("an empty scenario", "run mine.toml", 2, file("mine.toml", "")),
    Row("a folder for a scenario", "run .", 2),
    Row("an unknown key", "run line --set freindly=1", 2),
    Row("a number that is none", "run line --set friction=nan", 2),
    Row("a timestep of 0", "run line --set timestep=0", 2),
    Row("a timestep too long", f"run line {GO} --set timestep=0.004", 2),
    Row("strokes beyond the range", "plan line --segments 1", 4),
    Row("no way to go", "plan line --set path.goal=[0,0,0]", 0),
    Row("too little time", "plan corridor --set plan_time=1e-3", 4),
    Row("MJCF that is none", "robots mine.xml", 3, file("mine.xml", "<mujoco")),
    Row("a mass that is none", "robots mine.xml", 3, robot('mass="1"', 'mass="nan"')),
    Row(
        "gravity that is none",
        "robots mine.xml",
        3,
        world('<option gravity="0 0 nan"/>'),
    ),
    Row(
        "a file of somebody else's",
        "robots mine.xml",
        3,
        world(
            '<compiler discardvisual="true"/>'
            '<asset><texture type="2d" name="t" file="/etc/hostname"/></asset>'
        ),
    ),
    Row("a missing include", "robots mine.xml", 3, world('<include file="no.xml"/>')),
    Row("a model of 300,000 copies", "robots mine.xml", 3, inside(BOMB)),
    Row("an engine without memory", "robots mine.xml", 3, world(SMALL)),
    Row("a missing joint", "robots mine.xml", 3, robot('= "swing_1"', '= "hip"')),
    Row("servos too soft", f"run line {GO} --set servo_stiffness=1e-9", 3),
    Row("a start in the air", "robots mine.xml", 0, robot("0 0 0.06 1", "0 0 0.5 1")),
    Row("a start upside down", "robots mine.xml", 3, robot("0.06 1 0", "0.3 0 1")),
    Row("zeros for a quaternion", "robots mine.xml", 3, robot("0.06 1", "0.06 0")),
    Row("a walk that diverges", f"run line {GO} {WILD}", 4),
    Row("a run folder that exists", f"run line {GO} --out .", 2),
    Row("a run folder that cannot be", f"run line {GO} --out /proc/run", 6),
    Row("a plan that exists", "plan biped --save a.json", 2, file("a.json", "")),
    Row("a system that exits", "check mine.py", 2, file("mine.py", "raise SystemExit")),
    Row("a Python error", "check mine.py", 2, file("mine.py", "1 / 0")),
)  # fmt: skip


def told(row: Row) -> tuple[int, str, int]:
    """Code, first line and number of lines on standard error of a row's command."""
    with tempfile.TemporaryDirectory() as folder:
        row.make(Path(folder))
        done = subprocess.run(
            [sys.executable, "-m", "sim.cli", *shlex.split(row.command)],
            cwd=folder,
            env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
        )
        lines = done.stderr.splitlines()
        said = lines[0].removeprefix("stratawalk: error: ") if lines else ""
        said = said.replace(f"{folder}/", "").replace(f"{ROOT}/", "")
        return done.returncode, said, len(lines)


def main() -> int:
    """Run all rows; 1 if one does not end as it must."""
    wrong, lines = 0, []
    for row in ROWS:
        code, said, count = told(row)
        right = code == row.code and count == (code != 0)
        wrong += not right
        said = said.replace("|", "\\|")
        mark = "" if right else f" (must be {row.code}, {count} lines)"
        lines.append(f"| {row.fault} | `{row.command}` | {code}{mark} | {said} |")
        print(lines[-1], flush=True)
    (ROOT / "docs" / "faults.md").write_text(HEAD + "\n".join(lines) + "\n")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
