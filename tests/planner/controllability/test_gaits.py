"""Gait controllability: both tests of Sec. 4, what decides, and what is missing."""

import numpy as np
import pytest
import sympy as sp

from planner.controllability.gaits import gait_controllability
from planner.errors import SingularConfigurationError, StratumError
from planner.systems import closure
from planner.systems.closure import involutive_closure
from planner.systems.fields import NumericField
from planner.systems.strata import StratifiedSystem
from tests.systems import GAIT, X, Y, chained, flat_power, heisenberg, hexapod

HOME = [0.0] * 7


def lifted_only():
    """The hexapod without fields on the bottom stratum."""
    robot = hexapod(heights=True)
    strata = {"12": {}, "1": robot.strata["1"], "2": robot.strata["2"]}
    return StratifiedSystem(robot.state, strata, "12", robot.level_sets)


def test_tripod_gait_of_the_hexapod_is_controllable_by_the_papers_test():
    report = gait_controllability(hexapod(heights=True), GAIT, HOME)
    assert report.controllable
    assert report.conclusive
    assert report.decided_by == "filtration"
    assert (report.rank, report.dimension, report.missing) == (5, 5, ())


def test_gait_that_never_swings_loaded_feet_is_decided_by_the_closure():
    # the filtration never brackets fields of S1 with those of S2
    report = gait_controllability(lifted_only(), GAIT, HOME)
    assert report.controllable
    assert report.decided_by == "closure"
    assert (report.filtration, report.closure) == (4, 5)


def test_standing_hexapod_cannot_turn_without_its_legs():
    report = gait_controllability(hexapod(), ("12",), [0, 0, 1.0, 0, 0])
    assert not report.controllable
    assert report.conclusive
    assert (report.rank, report.decided_by) == (4, "neither")
    assert report.missing == ("theta - phi_1 + phi_2",)
    assert report.advice[:2] == ("visit S1", "visit S2")
    assert "no motion along theta - phi_1 + phi_2; visit S1" in str(report)


def test_missing_direction_is_named_in_the_body_frame_it_has():
    sliding = StratifiedSystem(
        "x y theta", {"0": {"g": [1, 2, 0], "t": [0, 0, 1]}}, "0"
    )
    report = gait_controllability(sliding, ("0",), [0, 0, 0])
    assert report.missing == ("x - 0.5 y",)
    assert report.advice == ("give some stratum a field that moves along x - 0.5 y",)


@pytest.mark.parametrize("power", [1, 2, 5, 8])
def test_flat_field_needs_brackets_of_its_power_plus_one(power):
    report = gait_controllability(flat_power(power), ("0",), [0, 0])
    assert report.controllable
    assert report.depth == power + 1


def test_stalled_rank_is_no_answer():
    report = gait_controllability(flat_power(5), ("0",), [0, 0], max_depth=4)
    assert not report.controllable
    assert not report.conclusive
    assert "form brackets beyond degree 4" in report.advice
    assert "has not been shown to be controllable" in str(report)


def test_complete_algebra_of_too_low_rank_is_an_answer():
    # the fields commute: no bracket of any degree adds anything
    flat = StratifiedSystem((X, Y), {"0": {"g": [1, 1], "f": [2, 2]}}, "0")
    report = gait_controllability(flat, ("0",), [0, 0])
    assert (report.controllable, report.conclusive) == (False, True)


@pytest.mark.parametrize("size", [3, 4, 6])
def test_chained_forms_are_controllable_everywhere(size):
    report = gait_controllability(chained(size), ("0",), np.arange(size))
    assert report.controllable


def test_fields_that_leave_the_bottom_count_by_their_tangent_part():
    state = sp.symbols("x y h")
    strata = {
        "on": {"slide": [1, 0, 0]},
        "off": {"raise": [0, 0, 2], "swing": [0, 1, X]},
    }
    crane = StratifiedSystem(state, strata, "on", {"on": [state[2]]})
    report = gait_controllability(crane, ("on", "off", "on"), [0, 0, 0])
    assert report.closure == 2


def test_fields_are_compared_where_all_are_finite():
    # the square root is not finite at a part of the points around the configuration
    fields = {"along": [1, 0], "root": [0, sp.sqrt(X)], "again": [0, sp.sqrt(X)]}
    system = StratifiedSystem((X, Y), {"0": fields}, "0")
    algebra = involutive_closure(system.strata["0"], (X, Y), [0.5, 0.0], max_depth=1)
    assert algebra.names == ("along", "root")


def test_numeric_fields_are_tested_too():
    fields = {
        "g1": NumericField(lambda x: [1, 0, -x[1] / 2]),
        "g2": NumericField(lambda x: [0, 1, x[0] / 2]),
    }
    numeric = StratifiedSystem("x y z", {"0": fields}, "0")
    assert gait_controllability(numeric, ("0",), [0.3, 0.2, 0.1]).controllable


@pytest.mark.parametrize(
    ("at", "message"),
    [
        ([0, 0], r"configuration has shape \(2,\), expected \(7,\): x, y, theta"),
        ([0, 0, np.nan, 0, 0, 0, 0], "is not finite"),
        (
            [0, 0, 0, 0, 0, 0.1, 0],
            "first stratum: height_1 is not 0 there; choose one whe",
        ),
    ],
)
def test_configurations_that_are_not_in_the_first_stratum_are_refused(at, message):
    with pytest.raises(ValueError, match=message):
        gait_controllability(hexapod(heights=True), GAIT, at)


def smooth(state, at, **fields):
    system = StratifiedSystem(state, {"0": fields}, "0")
    return gait_controllability(system, ("0",), at)


Z = sp.Symbol("z")
AWAY = [  # fields that are undefined, zero or huge between -1 and 1
    *(((X, Y, Z), (0, 0, 0), {"a": [sp.exp(size * Z), sp.sin(Z), 0], "b": [0, 0, 1]})
      for size in (100, 1000)),
    ((X, Y), (6, 0), {"a": [sp.sqrt(X - 5), 0], "b": [0, 1]}),
    ((X, Y, Z), (4, 0, 0), {"a": [1, 0, 0], "b": [0, 1, sp.log(X - 3)]}),
    ((X, Y), (3, 0), {"a": [1, 0], "b": [0, sp.sqrt((X - 2) ** 2) + X - 2]}),
]  # fmt: skip


@pytest.mark.parametrize(("state", "at", "fields"), AWAY)
def test_fields_are_compared_around_the_configuration(state, at, fields):
    assert smooth(state, at, **fields).controllable


def test_field_that_is_singular_at_the_configuration_is_refused():
    with pytest.raises(
        SingularConfigurationError, match=r"b is not finite at \(0, 1\)"
    ):
        smooth((X, Y), [0, 1], a=[1, 0], b=[0, 1 / X])


@pytest.mark.parametrize(
    ("state", "at", "fields"),
    [
        ((X,), [np.pi], {"a": [sp.sin(X)]}),
        ((X,), [0.3], {"a": [X - sp.Float(0.1) - sp.Float(0.2)]}),
        ((X,), [0.1 + 0.2], {"a": [sp.sin(X) - sp.sin(sp.Float(0.3))]}),
    ],
)
def test_rounding_is_no_direction(state, at, fields):
    report = smooth(state, at, **fields)
    assert (report.rank, report.conclusive) == (0, True)


@pytest.mark.parametrize("size", [1e-12, 1e-5, 1, 1e9])
def test_controllability_does_not_depend_on_units(size):
    small = {"a": [size, 0, 0], "b": [0, size, size * X]}
    assert smooth((X, Y, Z), [0, 0, 0], **small).controllable
    assert smooth((X, Y), [0, 0], a=[size, 0], b=[0, 1 / size]).controllable


def test_slow_lift_is_a_lift_and_what_it_lifts_is_judged():
    crane = StratifiedSystem(
        "x y h",
        {
            "on": {},
            "off": {"lift": [0, 0, 1e-9], "go": [1, 0, 1e-9], "y": [0, 1e-9, 0]},
        },
        "on",
        {"on": ["h"]},
    )
    report = gait_controllability(crane, ("on", "off", "on"), [0, 0, 0])
    assert (report.rank, report.controllable) == (2, True)


def test_fields_that_hardly_differ_are_judged_by_exact_arithmetic():
    # a + b, less c and d, is 2e-9 (cos, sin) along x and y; more is reached by far
    def biped(hip):
        theta = sp.Symbol("theta")
        along = [hip * sp.cos(theta), hip * sp.sin(theta)]
        return smooth(
            ("x", "y", "theta", "p", "q"),
            [0] * 5,
            a=[*along, 1, 1, 0],
            b=[*along, -1, 0, 1],
            c=[0, 0, 0, 1, 0],
            d=[0, 0, 0, 0, 1],
        )

    assert biped(1e-6).controllable
    near = biped(1e-9)
    assert (near.controllable, near.conclusive) == (True, True)


def test_fields_that_lifting_changes_leave_the_question_open():
    # Assumption 2 fails: lift, move by h d/dx and land goes along x
    x, y, h = sp.symbols("x y h")
    strata = {"1": {"b": [0, x, 0]}, "0": {"lift": [0, 0, 1], "move": [h, 0, 0]}}
    system = StratifiedSystem((x, y, h), strata, "1", {"1": [h]})
    report = gait_controllability(system, ("1", "0", "1"), [0, 0, 0])
    assert (report.controllable, report.conclusive) == (False, False)
    assert "make move independent of what lift lifts (eq. 13)" in report.advice


def test_functions_get_the_verdict_of_their_formulas():
    def crane(**off):
        strata = {"1": {"a": [1, 0, 0, 0]}, "0": off}
        system = StratifiedSystem("x y z h", strata, "1", {"1": ["h"]})
        return gait_controllability(system, ("1", "0", "1"), [0, 0, 0, 0])

    formulas = crane(lift=[0, 0, 0, 1], move=[0, 1, X, 1])
    functions = crane(lift=lambda x: [0, 0, 0, 1], move=lambda x: [0, 1, x[0], 1])
    assert (formulas.controllable, formulas.closure) == (True, 3)
    assert (functions.controllable, functions.closure) == (True, 3)


def test_algebra_whose_formulas_grow_without_end_is_given_up_openly(monkeypatch):
    # on spheres all along, yet every degree adds fields six times as long
    monkeypatch.setattr(closure, "MOST_OPERATIONS", 2_000)
    grown = {
        "a": [0, -Z * sp.exp(X), Y * sp.exp(X)],
        "b": [Z * sp.sin(Y + 2), 0, -X * sp.sin(Y + 2)],
    }
    report = smooth((X, Y, Z), [1, 1, 1], **grown)
    assert (report.rank, report.conclusive) == (2, False)
    assert report.depth < 12
    assert any(a.startswith("simplify the fields") for a in report.advice)


def test_walk_that_is_no_gait_is_refused():
    with pytest.raises(StratumError, match="steps from S1 to S2"):
        gait_controllability(hexapod(), ("1", "2", "1"), [0] * 5)


def test_closure_of_the_heisenberg_fields_has_three_fields_and_is_complete():
    system = heisenberg()
    algebra = involutive_closure(system.fields, system.state, [0, 0, 0], max_depth=9)
    assert (len(algebra.fields), algebra.depth, algebra.complete) == (3, 2, True)
    assert algebra.names[2] == "[g1,g2]"


def test_closure_counts_fields_and_not_their_values_at_a_point():
    # x^2 d/dx and d/dx generate the three fields of sl(2), all along one line
    fields = {"a": sp.ImmutableMatrix([1]), "b": sp.ImmutableMatrix([X**2])}
    algebra = involutive_closure(fields, (X,), [0], max_depth=9)
    assert (len(algebra.fields), algebra.complete) == (3, True)


@pytest.mark.parametrize(
    ("largest", "max_depth", "depth"), [(150, 4, 4), (4, 6, 3), (3, 6, 2), (1, 6, 1)]
)
def test_closure_that_is_cut_short_tells_the_last_degree_it_has_in_full(
    monkeypatch, largest, max_depth, depth
):
    """Every degree of x^9 d/dy adds one field to the two generators."""
    monkeypatch.setattr(closure, "MOST_FIELDS", largest)
    system = flat_power(9)
    algebra = involutive_closure(system.fields, system.state, [1, 0], max_depth)
    assert (algebra.depth, algebra.complete) == (depth, False)


def test_depth_below_one_is_refused():
    with pytest.raises(ValueError, match="depth is 0; at least 1"):
        involutive_closure(heisenberg().fields, heisenberg().state, [0, 0, 0], 0)


def test_a_coupling_below_the_tolerance_of_the_rank_is_no_final_answer():
    fields = {"drive": ["cos(a)", "1e-12*sin(a)", 0], "turn": [0, 0, 1]}
    found = gait_controllability(
        StratifiedSystem("x y a", {"0": fields}, "0"), ("0",), (0, 0, 0.5)
    )
    assert (found.controllable, found.conclusive) == (False, False)
    assert "has not been shown to be controllable" in str(found)
