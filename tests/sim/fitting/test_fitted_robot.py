"""A robot is played, fitted to what was measured, and played again.

A hidden robot has softer servos, a load, a slope and late commands. A motion is played
on it, and its joints and its body are measured with noise. `fit` reads that log and
writes a card; then another motion is played on the hidden robot, on the robot as it was
described, and on the one that was fitted. It takes a minute or two.
"""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest

from models import load
from sim import cli
from sim.fitting.poses import log_of
from sim.logs.log import Log, written
from sim.runs.run import read_run

ROBOT = "hexapod"
HIDDEN = {
    "servo_stiffness": 60.0, "command_delay": 0.03, "friction": 0.7,
    "payload": [0.1, 0.02, 0.01, 0.0], "slope": [0.02, 0.5],
}  # fmt: skip
NOISE = 0.2e-3, np.radians(0.05)  # of a place [m], of an angle [rad]
PERIOD = 4.0  # [s]


def motion(path: Path, amplitude: float, turn: float, periods: int) -> None:
    """Write a gait of two tripods; each swings on the floor while the other returns."""
    robot = load(ROBOT)
    time = np.arange(0, periods * PERIOD + 0.01, 0.02)
    swing, lift = np.zeros((2, len(time), 2))
    for group in range(2):
        part = (time / PERIOD + 0.5 * group) % 1
        rise, fall = part / 0.08, (part - 0.4) / 0.08
        lift[:, group] = 0.3 * (_smooth(rise) - _smooth(fall))
        there, back = _smooth((part - 0.1) / 0.28), _smooth((part - 0.55) / 0.4)
        size = amplitude * (1 + turn * (2 * group - 1))
        swing[:, group] = size * (2 * (there - back) - 1)
    swing *= _smooth(time / 0.3)[:, None]
    angles = robot.leg_angles(swing, lift)
    joints = robot.card.joints
    rows = [robot.standing_angle(joint) + angles[joint] for joint in joints]
    path.write_text(written(Log(time, joints, np.stack(rows, axis=1))))


def _smooth(part: np.ndarray) -> np.ndarray:
    part = np.clip(part, 0, 1)
    return part * part * (3 - 2 * part)


def played(robot: str, file: Path, out: Path, **settings: object) -> Path:
    """The run folder of a motion played on a robot."""
    words = ["play", robot, str(file), "--no-video", "--out", str(out)]
    for key, value in {"predictions": ["ideal"], **settings}.items():
        words += ["--set", f"{key}={json.dumps(value)}"]
    with contextlib.redirect_stdout(None):
        code = cli.main([*words, "--tolerance", "none"])
    if code not in (0, 4):
        raise RuntimeError(f"stratawalk {' '.join(words)} ended with {code}")
    return out


def measured(folder: Path, told: Path, out: Path) -> None:
    """Write what was told, and what was measured on the hidden robot, with noise."""
    run, random = read_run(folder), np.random.default_rng(1)
    found = log_of(run)
    table = np.genfromtxt(told, delimiter=",", names=True, deletechars="")
    commanded = [np.interp(found.time, table["time"], table[j]) for j in found.joints]
    position, angle = NOISE
    if found.pose is None or found.measured is None:
        raise ValueError("a walk has poses and angles")
    rows, width = found.measured.shape
    pose = found.pose + random.normal(0, [position, position, angle], (rows, 3))
    joints = found.measured + random.normal(0, angle, (rows, width))
    log = Log(found.time, found.joints, np.stack(commanded, axis=1), joints, pose)
    out.write_text(written(log))


def missed(folder: Path, truth: Path) -> float:
    """Root mean square of the way between two walks' bodies [m]."""
    one, other = read_run(folder), read_run(truth)
    off = (one.achieved - other.achieved)[:, :2]
    return float(np.sqrt((off**2).sum(axis=1).mean()))


def tried(folder: Path) -> tuple[float, float]:
    """How far the described and the fitted robot are from the hidden one [m]."""
    first, second = folder / "first.csv", folder / "second.csv"
    motion(first, 0.2, 0.0, 3)
    motion(second, 0.15, 0.4, 2)
    hidden = played(ROBOT, first, folder / "hidden-1", **HIDDEN)
    log, card = folder / "log.csv", folder / "fitted.toml"
    measured(hidden, first, log)
    if cli.main(["fit", ROBOT, str(log), "--out", str(card)]):
        raise RuntimeError("it could not be fitted")
    truth = played(ROBOT, second, folder / "hidden-2", **HIDDEN)
    described = played(ROBOT, second, folder / "described")
    fitted = played(str(card.with_suffix(".xml")), second, folder / "fitted-run")
    return missed(described, truth), missed(fitted, truth)


@pytest.mark.full
@pytest.mark.physics
def test_a_fitted_robot_goes_where_the_hidden_one_goes(tmp_path):
    before, after = tried(tmp_path)
    assert after < 0.1 * before  # 0.03 measured
