"""What rounding may leave of a plan's places, and how large plans may become."""

import numpy as np
import pytest
import sympy as sp

from planner.errors import BoundError, StratumError
from planner.planning.archive import load_plan
from planner.planning.lifted_ends import set_down, stratum_at
from planner.planning.nominal import sample
from planner.planning.paths import line
from planner.planning.rates import _values, vanishes
from planner.planning.subdivision import Slack, needed, subdivide
from planner.systems.strata import StratifiedSystem

WALKER = StratifiedSystem(
    "x h", {"1": {"f": [1, 0]}, "0": {"up": [0, 1]}}, "1", {"1": ["h"]}
)


def test_feet_are_on_the_ground_within_a_billionth():
    assert (
        stratum_at(WALKER, (0.0, 0.9e-9)) == stratum_at(WALKER, (0.0, -0.9e-9)) == "1"
    )
    assert stratum_at(WALKER, (0.0, 1.1e-9)) == "0"
    assert set_down(WALKER, (2.0, 1.1e-9)).tolist() == [2.0, 0.0]
    assert set_down(WALKER, (2.0, -0.9e-9))[1] == -0.9e-9
    with pytest.raises(StratumError):
        set_down(WALKER, (2.0, -1.1e-9))


def test_rounding_takes_a_billionth_of_a_unit_from_a_path_at_most():
    """Floating-point numbers from four million on are 2^-30 apart."""
    far = line([2.0**22], [2.0**22 + 1])
    for weight, kept in ((1e-9 * 2**30 * 0.99, True), (1e-9 * 2**30 * 1.01, False)):
        strata = {"0": {"f": [1]}}
        system = StratifiedSystem("x", strata, "0", metric={"x": weight})
        if kept:
            sample(far, system, 1, 3)
        else:
            with pytest.raises(ValueError, match="steps of 1e-09 are lost to rounding"):
                sample(far, system, 1, 3)


def test_expressions_vanish_that_are_smaller_than_1e_8_within_a_third_of_zero():
    x = sp.Symbol("x")
    assert vanishes(sp.Float(0.9e-8), (x,))
    assert not vanishes(sp.Float(1.1e-8), (x,))
    assert vanishes(sp.Float(1.8e-8), (x,), 2.0)
    assert 0.25 < np.abs(_values(x, (x,))).max() < 1 / 3


def test_a_plan_that_is_read_has_fifty_megabytes_at_most(tmp_path):
    for size, refusal in ((50_000_000, "is not JSON"), (50_000_001, "than 50 MB")):
        with (tmp_path / "plan.npz").open("wb") as file:
            file.truncate(size)
        with pytest.raises((OSError, ValueError), match=refusal):
            load_plan(tmp_path / "plan.npz")


def test_a_path_is_divided_into_a_thousand_segments_at_most():
    def slacks(counts):
        """Slacks of bounds that are kept once segments are cut into so many pieces."""

        def found(cuts):
            more = np.sqrt(counts) if len(cuts) == 501 else np.zeros(500)
            walking = np.where(more > 0, 1.0 - more, 0.5)
            shape = np.ones(len(cuts) - 1)
            return [Slack("bound", 0.0, shape, np.resize(walking, len(cuts) - 1))]

        return found

    halves = np.full(500, 1.9)
    cuts = np.linspace(0.0, 1.0, 501)
    assert len(subdivide(cuts, slacks(halves))) == 1001
    with pytest.raises(BoundError, match="1000"):
        subdivide(cuts, slacks(np.r_[2.9, halves[1:]]))


@pytest.mark.parametrize(("departure", "pieces"), [(1.4, 2), (1.5, 3), (9.0, 3)])
def test_a_motion_departs_by_the_square_root_of_a_segments_length(departure, pieces):
    """So half the departure takes four pieces, though three at once are the most."""
    slack = Slack("bound", 0.0, np.ones(1), np.array([1.0 - departure]))
    assert needed(slack).tolist() == [pieces]
