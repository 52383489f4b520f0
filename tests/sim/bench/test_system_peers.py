"""CasADi and OMPL on shipped systems: what they report is so."""

import numpy as np
import pytest

from models.systems.catalogue import shipped_system
from sim.bench.system_peers import casadi_cell, end_of, generators, ompl_cell


def test_rounds_of_single_fields_end_where_their_flows_lead():
    problem = shipped_system("unicycle")
    assert generators(problem) == ("drive", "turn")
    end = end_of(problem, np.array([1.0, np.pi / 2, 2.0]))
    assert end == pytest.approx([1, 2, np.pi / 2], abs=1e-12)


def test_optimised_durations_meet_the_goal_on_the_exact_kinematics():
    pytest.importorskip("casadi")
    flows, missed, _ = casadi_cell(shipped_system("brockett")).split(", ")
    assert int(flows) <= 12
    assert float(missed.removesuffix(" off")) < 1e-6


def test_sampled_controls_are_single_fields():
    pytest.importorskip("ompl")
    flows, missed = ompl_cell(shipped_system("heisenberg")).split(", ")
    assert int(flows) > 0
    assert float(missed.removesuffix(" off")) > 1e-6  # it samples
