"""Ctrl-C during a search takes the best plan so far, or ends in one line."""

import subprocess
import sys

import pytest

from tests.commands import OUTSIDE, refusal

pytest.importorskip("casadi")

INTERRUPTED = """
import os, runpy, signal, sys
from planner.optimisation.windows import WindowSearch

def interrupted(self, *given):
    os.kill(os.getpid(), signal.SIGINT)

setattr(WindowSearch, sys.argv.pop(1), interrupted)
runpy.run_module("sim.cli", run_name="__main__", alter_sys=True)
"""
PLANNED = ("plan", "line", "--optimise", "time", "--segments", "1")
NEAR = ("path.goal=[0.005,0.005,0]", "path_tolerance=0.02", "yaw_tolerance=3.2")


def interrupted_in(method):
    settings = [word for key in NEAR for word in ("--set", key)]
    return subprocess.run(
        [sys.executable, "-c", INTERRUPTED, method, *PLANNED, *settings],
        env=OUTSIDE,
        capture_output=True,
        text=True,
    )


def test_once_a_plan_is_found_it_is_taken():
    done = interrupted_in("_improve")
    assert done.returncode == 0
    assert "Ctrl-C ended the search, whose best plan is taken" in done.stderr
    assert "off goal  0.00 mm" in done.stdout
    assert "stratified" not in done.stdout  # nothing falls back


def test_before_a_plan_is_found_the_command_ends():
    done = interrupted_in("_fewest")
    assert done.returncode == 130
    assert "interrupted: Ctrl-C" in refusal(done)
    assert done.stdout == ""
