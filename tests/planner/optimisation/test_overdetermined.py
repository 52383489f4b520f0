"""Programs that no solver can solve are not tried."""

import numpy as np
import pytest

from planner.optimisation import program as programs
from planner.optimisation.program import Program
from planner.optimisation.task import Solution
from tests.planner.optimisation.test_program import COUNT, FIRST, START, WAY, task_of

pytest.importorskip("casadi")


def test_a_program_with_more_equations_than_free_unknowns_is_not_tried(
    monkeypatch,
):
    """The solver would search for a point that meets them, and warn at every call."""
    monkeypatch.setattr(programs, "Ipopt", lambda *parts: None)
    program = Program(task_of(), WAY, COUNT, FIRST)
    start, states = np.zeros((2, 5)), np.zeros((COUNT + 1, len(START)))
    guess = Solution(FIRST, None, None, states, None, np.inf, np.inf)
    monkeypatch.setattr(type(program._constraints), "bounds", lambda *_: start)
    monkeypatch.setattr(type(program.unknowns), "packed", lambda *_: start[0])
    tried = []
    program._solver = lambda **given: tried.append(given)
    for free, count in ((4, 0), (5, 1)):
        most = np.array([1.0] * free + [0.0] * (9 - free))
        monkeypatch.setattr(
            type(program.unknowns), "bounds", lambda *_, most=most: (0 * most, most)
        )
        assert program.solve(guess, (0.0, 1.0), None) is None
        assert len(tried) == count
