"""Shipped walkers: a biped on its hips, and feet that share their slip."""

import numpy as np
import pytest
import sympy as sp

from models.systems.catalogue import shipped_system
from models.systems.legged import shared
from planner.controllability.gaits import gait_controllability


def test_biped_stays_put_on_two_feet_and_needs_brackets_across_strata():
    problem = shipped_system("biped")
    assert not problem.system.strata["12"]
    report = gait_controllability(problem.system, problem.gait, problem.states[0])
    assert (report.filtration, report.closure) == (4, 5)
    assert report.decided_by == "closure"


@pytest.mark.parametrize(("field", "side"), [("g1_1", 1), ("g2_2", -1)])
def test_biped_turns_about_the_hip_that_stands(field, side):
    hip = 0.3
    system = shipped_system("biped", {"hip": hip}).system
    x, y, theta = (sp.Symbol(name) for name in ("x", "y", "theta"))
    place = sp.Matrix([x - side * hip * sp.sin(theta), y + side * hip * sp.cos(theta)])
    velocity = place.jacobian(sp.Matrix(system.state)) * system.fields[field]
    assert sp.simplify(velocity) == sp.zeros(2, 1)


def slip(feet, stratum, group, twist):
    """Sum over the feet in contact of squared slip velocities, a group swinging."""
    forward, left, yaw = twist
    return sum(
        (forward - yaw * y - (owner == group)) ** 2 + (left + yaw * x) ** 2
        for owner in stratum
        for x, y in feet[owner]
    )


@pytest.mark.parametrize("stratum", ["1234", "234", "124", "14"])
def test_no_other_twist_slips_less_than_the_shared_one(stratum):
    feet = {"1": [(1, 1)], "2": [(1, -1)], "3": [(-2, 1)], "4": [(-1, -1), (0, -2)]}
    others = np.random.default_rng(0).normal(scale=0.1, size=(20, 3))
    for group, twist in shared(feet, (stratum,))[stratum].items():
        best = np.array(twist, dtype=float)
        least = slip(feet, stratum, group, best)
        assert all(slip(feet, stratum, group, best + other) > least for other in others)


def test_legs_of_one_side_push_straight_ahead_with_those_of_the_other():
    feet = {"1": [(1, 1), (-1, 1)], "2": [(1, -1), (-1, -1)]}
    left, right = shared(feet, ("12",))["12"].values()
    assert np.add(left, right).tolist() == [1, 0, 0]


def at_zero(system, field):
    """Twist of a field where the body stands at the origin and faces ahead."""
    still = dict.fromkeys(system.state, 0)
    return np.array([float(e.subs(still)) for e in system.fields[field][:3]])


@pytest.mark.parametrize(
    ("name", "left", "right"),
    [
        ("octopod-pairs", "g14_1", "g23_2"),
        ("octopod-pairs", "g14_4", "g23_3"),
        ("octopod-pairs", "g1234_1", "g1234_2"),
        ("octopod-pairs", "g1234_3", "g1234_4"),
        ("quadruped-crawl", "g1234_1", "g1234_2"),
        ("quadruped-crawl", "g234_3", "g134_4"),
        ("quadruped-crawl", "g124_1", "g123_2"),
        ("quadruped-crawl", "g234_2", "g134_1"),
    ],
)
def test_legs_of_both_sides_move_the_body_as_mirrored(name, left, right):
    system = shipped_system(name).system
    mirrored = at_zero(system, left) * [1, -1, -1]
    assert at_zero(system, right) == pytest.approx(mirrored)
    assert mirrored[0] > 0


def feet_of(name, length, width):
    """Feet of each group, which are as far apart as length and width say."""
    x, y = length / 2, width / 2
    if name == "quadruped-crawl":
        return {"1": [(x, y)], "2": [(x, -y)], "3": [(-x, y)], "4": [(-x, -y)]}
    return {
        "1": [(x, y), (-x / 3, y)],
        "2": [(x, -y), (-x / 3, -y)],
        "3": [(x / 3, y), (-x, y)],
        "4": [(x / 3, -y), (-x, -y)],
    }


@pytest.mark.parametrize(
    ("name", "usual"), [("quadruped-crawl", (2.0, 1.0)), ("octopod-pairs", (3.0, 1.0))]
)
def test_length_and_width_are_those_between_the_outermost_feet(name, usual):
    for length, width in ((2.4, 0.8), usual):
        given = {} if (length, width) == usual else {"length": length, "width": width}
        system = shipped_system(name, given).system
        feet = feet_of(name, length, width)
        for stratum in system.strata:
            for group, twist in shared(feet, (stratum,))[stratum].items():
                found = at_zero(system, f"g{stratum}_{group}")
                assert found == pytest.approx(np.array(twist, dtype=float))
