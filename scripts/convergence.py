"""How far the physics departs from its quasi-static prediction, setting by setting.

The study behind the defaults: a turning walk of six segments is repeated with one
setting changed at a time. Timesteps show that the numbers have converged, speeds from
when on the walk is no longer quasi-static, stiffness and friction what a real robot
with softer servos or a smoother floor must expect.

Example:
    python -m scripts.convergence --only timestep
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from sim.evaluate import Evaluation, evaluate
from sim.planning import plan_open_loop
from sim.scenario_file import load
from sim.setup import prepare
from sim.walk import walk

PATH = {"kind": "line", "goal": [0.03, 0.03, 0.314]}
STUDIES: dict[str, tuple[float, ...]] = {
    "timestep": (0.002, 0.001, 0.0005, 0.00025),
    "swing_speed": (0.25, 0.5, 1.0, 1.5, 3.0, 6.0),
    "servo_stiffness": (50.0, 100.0, 300.0, 1000.0, 3000.0),
    "friction": (0.3, 0.6, 0.9, 1.2),
}


def judged(**changes: object) -> Evaluation:
    """Walk the study's path with some settings changed."""
    setup = prepare(load("line", {"path": PATH, "segments": 6} | changes))
    return evaluate(walk(setup, plan_open_loop(setup)))


def row(setting: str, value: float) -> tuple[np.ndarray, str]:
    """One walk: the pose it ends in, and a line of the table."""
    changes: dict[str, object] = {setting: value}
    if setting == "swing_speed":
        changes["swing_acceleration"] = 10 * value
    result = judged(**changes)
    pose = result.achieved.pose[-1]
    off = pose - result.predicted["quasi_static"].pose[-1]
    path = result.walk.setup.scenario.path.length
    line = (
        f"{value:10g}{1e3 * np.hypot(*off[:2]):12.3f}{np.hypot(*off[:2]) / path:12.3%}"
        f"{1e3 * off[2]:12.3f}{1e3 * result.achieved.slip[-1].sum():10.1f}"
        f"{1e3 * result.predicted['quasi_static'].slip[-1].sum():10.1f}"
        f"{result.walk.recording.feet.bounces:9d}"
    )
    return pose, line


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", choices=STUDIES, help="one setting alone")
    chosen = parser.parse_args(arguments).only
    for setting, values in STUDIES.items():
        if chosen in (None, setting):
            study(setting, values)


def study(setting: str, values: Sequence[float]) -> None:
    """Print one table, and how far the end moves from one row to the next."""
    print(
        f"{setting:>10}{'off [mm]':>12}{'of path':>12}{'yaw [mrad]':>12}"
        f"{'slip [mm]':>10}{'predicted':>10}{'bounces':>9}{'moved [mm]':>12}"
    )
    before = None
    for value in values:
        pose, line = row(setting, value)
        moved = (
            "" if before is None else f"{1e3 * np.hypot(*(pose - before)[:2]):12.3f}"
        )
        print(line + moved, flush=True)
        before = pose
    print()


if __name__ == "__main__":
    main()
