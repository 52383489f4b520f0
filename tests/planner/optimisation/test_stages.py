"""Stages are read off the fields of a system."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from planner.errors import StratumError
from planner.optimisation.stages import Recovery, _recovery, amounts_of, cycle, swept
from planner.optimisation.task import Task
from planner.systems.flows import Flow


def names(problem):
    stages = cycle(problem.system, problem.elements)
    return [(s.stratum, s.stroke, *(r.field for r in s.recoveries)) for s in stages]


def test_a_biped_strokes_on_one_foot_while_the_other_recovers():
    assert names(shipped_system("biped")) == [
        ("1", "g1_1", "g1_2"),
        ("2", "g2_2", "g2_1"),
    ]


def test_legs_that_stroke_on_all_feet_recover_in_stages_of_their_own():
    assert names(shipped_system("paper-hexapod")) == [
        ("12", "g12_1"),
        ("2", "", "g2_1"),
        ("12", "g12_2"),
        ("1", "", "g1_2"),
    ]


def test_a_car_steers_before_it_drives():
    assert names(shipped_system("car")) == [("0", "drive", "steer")]


def test_foot_heights_are_no_concern_of_stages():
    problem = shipped_system("biped")
    stages = cycle(problem.system, problem.elements)
    assert swept(problem.system, stages) == (0, 1, 2, 3, 4)


def test_fields_that_move_one_coordinate_each_have_no_strokes():
    problem = shipped_system("biped")
    with pytest.raises(StratumError, match="no stroke"):
        cycle(problem.system, ["g1_2", "g2_1"])


def test_strokes_of_a_plan_fall_into_stages_in_their_order():
    problem = shipped_system("biped")
    stages = cycle(problem.system, problem.elements)
    flows = [
        Flow("1", "g1_2", 9.0),
        Flow("2", "g2_2", 0.1),
        Flow("2", "g2_2", 0.2),
        Flow("1", "g1_1", -0.5),
    ]
    assert amounts_of(stages, flows, 4) == pytest.approx(np.array([0, 0.3, -0.5, 0]))
    assert amounts_of(stages, flows, 2) is None


def test_a_recovery_moves_one_coordinate_at_a_constant_rate():
    x = sp.Symbol("x")
    columns = {"steady": [0, 3, 0], "varying": [0, x, 0], "both": [1, 3, 0]}
    found = {name: _recovery(name, sp.Matrix(c)) for name, c in columns.items()}
    assert found == {
        "steady": Recovery("steady", 1, 3.0),
        "varying": None,
        "both": None,
    }


def test_the_widest_stage_tells_how_many_recoveries_there_are():
    stages = [SimpleNamespace(recoveries=(0,) * count) for count in (1, 3, 2)]
    assert Task.most_recoveries.fget(SimpleNamespace(stages=stages)) == 3
