"""What directions cost in strokes, and ranks that hang on rounding."""

import numpy as np
import pytest
import sympy as sp

from planner.controllability.gaits import gait_controllability
from planner.extension.direction_costs import stroke_costs
from planner.systems.closure import exact_rank
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, METRES, X, Y, heisenberg, hexapod

RANGES = dict.fromkeys(("g1_1", "g2_2", "g1_2", "g2_1"), 0.9)  # [rad]


def costs(system, elements=LIFTED, strokes=RANGES):
    found = stroke_costs(system, elements, np.zeros(system.dimension), strokes)
    return {cost.direction: cost for cost in found}


def test_sideways_costs_the_strokes_of_its_rectangles():
    found = costs(hexapod(**METRES))
    # a rectangle of 0.9 by 0.9 rad goes 2 * 0.0378 * 0.56 * 0.81 m, by four strokes
    assert found["y"].strokes == pytest.approx(4 / (2 * 0.0378 * 0.56 * 0.81))
    assert found["y"].element == "[g1_1,g2_2]"
    assert not found["y"].in_theory_only


def test_straight_ahead_costs_both_tripods_and_their_recovery():
    assert costs(hexapod(**METRES))["x"].strokes == pytest.approx(2 / (0.0378 * 0.9))


def test_yaw_gain_left_by_rounding_gives_sideways_in_theory_only():
    found = costs(hexapod(0.1, 1e-5))
    assert found["y"].in_theory_only
    assert found["y"].strokes > 1e6
    assert not found["x"].in_theory_only


def test_units_of_the_state_do_not_change_what_is_in_reach():
    metres, millimetres = costs(hexapod(**METRES)), costs(hexapod(37.8, 0.56))
    for name, cost in metres.items():
        unit = 1000 if name in "xy" else 1
        assert cost.strokes == pytest.approx(unit * millimetres[name].strokes)


def test_fields_almost_alike_are_told_apart_by_exact_arithmetic():
    system = StratifiedSystem((X, Y), {"0": {"g1": [1, 0], "g2": [1, 1e-12]}}, "0")
    report = gait_controllability(system, ["0", "0"], [0.0, 0.0])
    assert report.controllable
    assert report.rank == 2
    assert costs(system, ("g1", "g2"), {})["y"].in_theory_only


def test_fields_alike_to_the_last_digit_stay_dependent():
    system = StratifiedSystem((X, Y), {"0": {"g1": [1, 0.1], "g2": [3, 0.3]}}, "0")
    rational = [sp.Matrix([1, sp.Rational(1, 10)]), sp.Matrix([3, sp.Rational(3, 10)])]
    assert exact_rank(rational, system.state, np.zeros(2)) == 1


def test_rank_of_fields_without_fractions_is_left_open():
    field = sp.Matrix([sp.cos(X), 1])
    assert exact_rank([field], (X, Y), np.array([0.3, 0.0])) is None
    assert exact_rank([field], (X, Y), np.zeros(2)) == 1
    assert (
        exact_rank(heisenberg().fields.values(), heisenberg().state, np.zeros(3)) == 2
    )
