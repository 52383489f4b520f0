"""Which fields raise feet, on bottoms that are curved or no submanifolds."""

import numpy as np
import pytest
import sympy as sp

from planner.controllability.gaits import gait_controllability
from planner.errors import StratumError
from planner.extension.extended import extend
from planner.extension.fields_on_bottom import lifts, tangent_field
from planner.systems.strata import StratifiedSystem

X, A, Z = sp.symbols("x a z")
AIR = {"swing": [0, 1, 0], "lift": [0, 0, 1]}


def bowl(order):
    """A foot on the bottom z = a^2, whose swing leaves it except at a = 0."""
    return StratifiedSystem(
        (X, A, Z),
        {"1": {"push": [1, 1, 2 * A]}, "0": {name: AIR[name] for name in order}},
        "1",
        {"1": (Z - A**2,), "0": ()},
    )


@pytest.mark.parametrize("order", [("lift", "swing"), ("swing", "lift")])
def test_lift_is_the_field_that_raises_the_foot_everywhere(order):
    system = bowl(order)
    assert lifts(system, "0") == ("lift",)
    extended = extend(system, ("push", "swing"))
    # the swing along the bowl, (0, 1, 2a), beside the push
    assert extended.columns(np.array([0.0, 0.5, 0.25])) == pytest.approx(
        np.array([[1, 0], [1, 1], [1, 1]])
    )
    assert gait_controllability(system, ["1", "0", "1"], [0, 0, 0]).rank == 2


def test_configuration_where_level_sets_cross_is_refused():
    system = StratifiedSystem(
        (X, A, Z),
        {"1": {"go": [1, 0, 0]}, "0": AIR},
        "1",
        {"1": (Z**2 - A**2,)},
        lifts={"0": ["lift"]},
    )
    assert gait_controllability(system, ["1", "0", "1"], [0, 1, 1]).dimension == 2
    with pytest.raises(ValueError, match=r"where they vanish \(Def. 1\), at \(0, 0, 0"):
        gait_controllability(system, ["1", "0", "1"], [0, 0, 0])


def on_a_slope(**declared):
    """Two fields that leave the floor, neither along the height alone."""
    air = {"swing": [1, 0, 1], "lift": [0, 1, 2]}
    return StratifiedSystem(
        "x a h", {"1": {}, "0": air}, "1", level_sets={"1": "h"}, **declared
    )


def test_a_lift_is_declared_where_two_fields_leave_the_floor():
    with pytest.raises(StratumError, match=r"which field lifts on S0, swing, lift\?"):
        tangent_field(on_a_slope(), "swing")
    told = on_a_slope(lifts={"0": ["lift"]})
    assert [float(e) for e in tangent_field(told, "swing")] == [1, -0.5, 0]
    assert tangent_field(told, "lift") is None
    with pytest.raises(ValueError, match="lift 'climb' of S0 is unknown; there are sw"):
        on_a_slope(lifts={"0": ["climb"]})
    with pytest.raises(ValueError, match="lifts of stratum '2', which is unknown"):
        on_a_slope(lifts={"2": ["lift"]})


def test_a_metric_gives_lengths_to_known_coordinates():
    assert on_a_slope(metric={"a": 0.2}).weights.tolist() == [1, 0.2, 1]
    with pytest.raises(ValueError, match="metric has b, which is unknown; there are x"):
        on_a_slope(metric={"b": 1})
    with pytest.raises(ValueError, match="metric has a = 0; give the length that a un"):
        on_a_slope(metric={"a": 0})
