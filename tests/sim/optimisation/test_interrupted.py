"""Ctrl-C during a search takes the best plan so far, or ends in one line."""

import os
import signal

import pytest

from planner.optimisation import windows
from sim.cli import main
from sim.problems.scenario import ScenarioProblem

pytest.importorskip("casadi")

PLANNED = ("plan", "line", "--optimise", "time", "--segments", "1")
NEAR = ("path.goal=[0.005,0.005,0]", "path_tolerance=0.02", "yaw_tolerance=3.2")
FEW = ("ANY_FIRST", "CLOSELY", "PATIENT_FOR", "FINALISTS", "ROUGHLY")


@pytest.fixture
def interrupted_in(monkeypatch, capsys):
    """Plan until a method of the search: the exit code, and what is printed where."""
    for name in FEW:
        monkeypatch.setattr(windows, name, 1)
    monkeypatch.setattr(ScenarioProblem, "least_time", None)  # takes seconds

    def plan(method):
        def interrupted(*given):
            os.kill(os.getpid(), signal.SIGINT)

        monkeypatch.setattr(windows.WindowSearch, method, interrupted)
        code = main([*PLANNED, *(word for key in NEAR for word in ("--set", key))])
        return code, *capsys.readouterr()

    return plan


def test_once_a_plan_is_found_it_is_taken(interrupted_in):
    code, out, err = interrupted_in("_improve")
    assert code == 0
    assert "Ctrl-C ended the search, whose best plan is taken" in err
    assert "off goal  0.00 mm" in out
    assert "stratified" not in out  # nothing falls back


def test_before_a_plan_is_found_the_command_ends(interrupted_in):
    code, out, err = interrupted_in("_fewest")
    assert code == 130
    (line,) = err.splitlines()
    assert line.startswith("stratawalk: error: interrupted: Ctrl-C")
    assert out == ""
