"""Small sweeps for tests: walks of a few seconds, run as the command runs them."""

import os
import subprocess
import sys
from pathlib import Path

from scripts.torture import TEXTS
from sim.pictures import gl
from tests import commands

ENV = {k: v for k, v in os.environ.items() if k != gl.ASKED}
ENV["PYTHONPATH"] = str(Path(__file__).parents[1])


def write_sweep(folder, varies, name="small"):
    """A sweep's file that differs from the base in what varies."""
    path = folder / f"{name}.toml"
    path.write_text(TEXTS["sweep"] + varies)
    return path


def command(*words):
    """The words that start the command in a process of its own."""
    return [sys.executable, "-m", "sim.cli", *map(str, words)]


def stratawalk(*words, env=ENV, timeout=300):
    """Run the command; its result with its messages."""
    if env is ENV:
        return commands.run(words, os.getcwd())
    return subprocess.run(
        command(*words), env=env, capture_output=True, text=True, timeout=timeout
    )


def poisoned(folder):
    """An environment in which a point of friction 0.666 kills its worker."""
    (folder / "sitecustomize.py").write_text(TEXTS["deadly"])
    path = os.pathsep.join([str(folder), ENV["PYTHONPATH"]])
    return ENV | {"PYTHONPATH": path}
