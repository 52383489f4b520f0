"""Small sweeps for tests: walks of a few seconds, run as the command runs them."""

import os
import subprocess
import sys
from pathlib import Path

from sim.pictures import gl

ENV = {k: v for k, v in os.environ.items() if k != gl.WISH}
ENV["PYTHONPATH"] = str(Path(__file__).parents[1])

BASE = """
scenario = "line"
without = ["identified", "creep_floor"]

[set]
segments = 1
path.goal = [0.002, 0.002, 0]
timestep = 0.002
hold = 0.1
swing_speed = 2.0
swing_acceleration = 20.0
allow_unstable = true
"""


def write_sweep(folder, varies, name="small"):
    """A sweep's file that differs from the base in what varies."""
    path = folder / f"{name}.toml"
    path.write_text(f"{BASE}\n{varies}\n")
    return path


def command(*words):
    """The words that start the command in a process of its own."""
    return [sys.executable, "-m", "sim.cli", *map(str, words)]


def stratawalk(*words, env=ENV, timeout=300):
    """Run the command; its result with what it said."""
    return subprocess.run(
        command(*words), env=env, capture_output=True, text=True, timeout=timeout
    )
