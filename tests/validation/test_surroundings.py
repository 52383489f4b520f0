"""Walks do not depend on what is around the command."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sim.cli import main

WALK = "--no-video --segments 1 --set path.goal=[0.005,0,0]"
WALK += ' --set predictions=["compliant"]'
ELSEWHERE = {
    "LC_ALL": "C",
    "PYTHONUTF8": "0",  # with the one above, text files are ASCII by default
    "TZ": "Asia/Tokyo",
    "PYTHONHASHSEED": "7",
    "OMP_NUM_THREADS": "1",
    "COLUMNS": "40",
    "TERM": "dumb",
}


@pytest.mark.physics
def test_bytes_do_not_depend_on_surroundings(tmp_path):
    here = {k: v for k, v in os.environ.items() if k != "HOME"}
    for name, more in (("a", os.environ), ("b", here | ELSEWHERE)):
        done = subprocess.run(
            [sys.executable, "-m", "sim.cli", "run", "line", *WALK.split()]
            + ["--out", str(tmp_path / name)],
            cwd=tmp_path,
            env={**more, "PYTHONPATH": os.getcwd()},
            capture_output=True,
        )
        # On a busy machine a stage lasts long enough to tell its progress in a pipe.
        words = re.sub(rb"(?m)^\w+ +\d+%, about \d+ s left\n", b"", done.stderr)
        assert (done.returncode, words) == (0, b"")
    for file in ("commands.npz", "trajectory.npz", "flows.csv", "model.xml"):
        first, second = (Path(tmp_path, name, file).read_bytes() for name in "ab")
        assert first == second


@pytest.mark.physics
def test_a_floor_without_friction_is_walked_on(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["run", "line", *WALK.split(), "--set", "friction=0"]
    assert main(words) == 7  # feet slide, and the body stays where it is
    assert "diverged" not in capsys.readouterr().err
