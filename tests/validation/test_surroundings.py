"""Walks do not depend on what is around the command."""

import shlex
import subprocess
from pathlib import Path

import pytest

from sim.cli import main
from tests.commands import COMMAND, OUTSIDE, run, told

WALK = "--no-video --segments 1 --set path.goal=[0.005,0,0]"
WALK += """ --set predictions='["compliant"]'"""
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
    words = ["run", "line", *shlex.split(WALK), "--out"]
    homeless = {k: v for k, v in OUTSIDE.items() if k != "HOME"} | ELSEWHERE
    usual = run([*words, "a"], tmp_path)
    other = subprocess.run(
        [*COMMAND, *words, "b"], cwd=tmp_path, env=homeless, capture_output=True
    )
    for code, said in (
        (usual.returncode, usual.stderr),
        (other.returncode, other.stderr.decode()),
    ):  # on a busy machine a stage lasts long enough to tell its progress in a pipe
        assert (code, told(said)) == (0, [])
    for file in ("commands.npz", "trajectory.npz", "flows.csv", "model.xml"):
        first, second = (Path(tmp_path, name, file).read_bytes() for name in "ab")
        assert first == second


@pytest.mark.physics
def test_a_floor_without_friction_is_walked_on(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["run", "line", *shlex.split(WALK), "--set", "friction=0"]
    assert main(words) == 7  # feet slide, and the body stays where it is
    assert "diverged" not in capsys.readouterr().err
