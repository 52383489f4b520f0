"""Whenever a walk is ended, and by whatever signal, the files left are whole."""

import json
import signal
import subprocess
import tomllib

import mujoco
import numpy as np
import pytest

from tests.commands import COMMAND, OUTSIDE

CODES = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGKILL: -signal.SIGKILL}
WALK = ("run", "line", "--segments", "4", "--set", "path.goal=[0.02,0.02,0]")


def moments():
    """Twenty moments, spread over the command from its start to its end [s]."""
    return [round(0.1 + 0.6 * i, 1) for i in range(20)]


def is_whole(path):
    """Whether a file can be read to its end."""
    if path.suffix == ".npz":
        with np.load(path) as file:
            return all(np.isfinite(file[name]).all() for name in ("time",))
    if path.suffix == ".json":
        return bool(json.loads(path.read_text()))
    if path.suffix == ".toml":
        return bool(tomllib.loads(path.read_text()))
    if path.name == "model.xml":
        return mujoco.MjModel.from_xml_path(str(path)).nq > 0
    return path.stat().st_size > 0


@pytest.mark.full
@pytest.mark.physics
@pytest.mark.parametrize("number", CODES, ids=lambda number: number.name)
def test_a_walk_that_is_ended_leaves_whole_files(tmp_path, number):
    for i, moment in enumerate(moments()):
        folder = tmp_path / str(i)
        process = subprocess.Popen(
            [*COMMAND, *WALK, "--no-video", "--out", folder],
            env=OUTSIDE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            _, said = process.communicate(timeout=moment)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            _, said = process.communicate(timeout=60)
        if moment > 1:  # earlier, Python itself may still be starting
            assert process.returncode in (0, CODES[number])
            assert len(said.splitlines()) <= 1
        left = folder.iterdir() if folder.exists() else ()
        parts = [path for path in left if path.name.startswith(".")]
        assert not parts or number == signal.SIGKILL
        whole = [path for path in folder.glob("*") if path.is_file()]
        assert all(is_whole(path) for path in whole if path not in parts)
