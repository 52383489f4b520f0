"""Trailers, of a walking robot and of cars: degrees they need, axles that roll."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from planner.controllability.gaits import gait_controllability
from planner.errors import RankError
from planner.planning.algorithm import plan
from planner.planning.rollouts import rollout
from planner.systems.fields import compile_fields, sample_configurations


def sideslip(problem, axle, heading):
    """Sideways velocities of an axle along every field, at random configurations."""
    system = problem.system
    left = sp.Matrix([[-sp.sin(heading), sp.cos(heading)]])
    slips = [
        left * axle.jacobian(sp.Matrix(system.state)) * f
        for f in system.fields.values()
    ]
    rows = compile_fields(slips, system.state)(sample_configurations(len(system.state)))
    return np.abs(rows).max()


def test_axle_of_the_hexapod_s_trailer_does_not_slip_sideways():
    problem = shipped_system("hexapod-trailer", {"length": 0.7})
    x, y, psi = (sp.Symbol(name) for name in ("x", "y", "psi"))
    axle = sp.Matrix([x - 0.7 * sp.cos(psi), y - 0.7 * sp.sin(psi)])
    assert sideslip(problem, axle, psi) < 1e-12  # rounding


def test_the_hexapod_s_trailer_is_one_unit_long_and_its_feet_have_heights():
    system = shipped_system("hexapod-trailer").system
    names = [str(symbol) for symbol in system.state]
    assert names[-2:] == ["height_1", "height_2"]
    rate = system.fields["g1_1"][names.index("psi")].subs({"theta": 0.3, "psi": 0.1})
    assert float(rate) == pytest.approx(np.sin(0.2))  # a speed of 1 over a length of 1


@pytest.mark.parametrize("trailers", [1, 2, 3])
def test_no_axle_of_a_car_with_trailers_slips_sideways(trailers):
    problem = shipped_system("car-trailers", {"trailers": trailers, "length": 0.7})
    axle = sp.Matrix(sp.symbols("x y"))
    for k in range(trailers + 1):
        heading = sp.Symbol(f"theta_{k}")
        if k:
            axle -= 0.7 * sp.Matrix([sp.cos(heading), sp.sin(heading)])
        assert sideslip(problem, axle, heading) < 1e-12  # rounding


def test_trailer_needs_degree_3():
    problem = shipped_system("hexapod-trailer")
    gait, start = problem.gait, problem.states[0]
    report = gait_controllability(problem.system, gait, start, max_depth=2)
    assert (report.controllable, report.rank, report.dimension) == (False, 5, 6)
    assert "psi" in " ".join(report.missing)
    assert "form brackets beyond degree 2" in report.advice
    assert gait_controllability(problem.system, gait, start, max_depth=3).controllable


def test_trailer_is_not_planned_with_brackets_to_degree_2():
    problem = shipped_system("hexapod-trailer")
    with pytest.raises(RankError, match=r"rank 5 of 6 .* nothing along y - psi; add"):
        plan(problem.system, problem.path, 1, problem.elements[:-1])


@pytest.mark.parametrize(
    ("name", "headings", "folded"),
    [
        ("hexapod-trailer", ["theta", "psi"], True),
        ("car-trailers", ["theta_0", "theta_1", "theta_2"], True),
        ("car", ["theta"], False),
    ],
)
def test_the_largest_angle_at_a_hitch_is_that_of_neighbouring_headings(
    name, headings, folded
):
    values = {"trailers": len(headings) - 1} if name == "car-trailers" else {}
    problem = replace(shipped_system(name, values), goal={"y": 1}, segments=1)
    names = [str(symbol) for symbol in problem.system.state]
    way = rollout(problem.plan(), 20)
    angles = np.diff(way[:, [names.index(heading) for heading in headings]], axis=1)
    largest = np.abs(angles).max(initial=0.0)
    assert problem.largest_fold(way) == pytest.approx(largest)
    assert bool(largest > np.pi / 2) is folded
