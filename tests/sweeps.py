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


FAULT = """
import importlib.abc, importlib.machinery, os, signal, sys

class Deadly(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name != "sim.sweeps.worker":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        execute = spec.loader.exec_module
        def poisoned(module):
            execute(module)
            walk = module.simulate
            def simulate(scenario, **options):
                if scenario.friction == 0.666:
                    os.kill(os.getpid(), signal.SIGKILL)
                return walk(scenario, **options)
            module.simulate = simulate
        spec.loader.exec_module = poisoned
        return spec

sys.meta_path.insert(0, Deadly())
"""
"""As `sitecustomize` of a process: a point of friction 0.666 kills its worker."""


def poisoned(folder):
    """An environment in which a point of friction 0.666 kills its worker."""
    (folder / "sitecustomize.py").write_text(FAULT)
    path = os.pathsep.join([str(folder), ENV["PYTHONPATH"]])
    return ENV | {"PYTHONPATH": path}
