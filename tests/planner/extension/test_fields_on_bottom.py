"""Which fields raise feet, on bottoms that are curved or no submanifolds."""

import numpy as np
import pytest
import sympy as sp

from planner.controllability.gaits import gait_controllability
from planner.extension.extended import extend
from planner.extension.fields_on_bottom import lifts
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
        (X, A, Z), {"1": {"go": [1, 0, 0]}, "0": AIR}, "1", {"1": (Z**2 - A**2,)}
    )
    assert gait_controllability(system, ["1", "0", "1"], [0, 1, 1]).dimension == 2
    with pytest.raises(ValueError, match=r"where they vanish \(Def. 1\), at \(0, 0, 0"):
        gait_controllability(system, ["1", "0", "1"], [0, 0, 0])
