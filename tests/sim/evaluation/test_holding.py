"""A measured prediction is left out of walks on which its error may add up."""

from types import SimpleNamespace

import numpy as np
import pytest

from models import IdentifiedTwists, MeasurementError
from models.motion import MeasuredField
from sim.evaluation.deviations import require_holding


def measured(stratum, off):
    still = np.polynomial.Polynomial([0.0])
    return MeasuredField(stratum, (1.0,), 0.25, (still,) * 3, slip=0.0, off=off)


def walk(distance, steered_on="ideal"):
    path = SimpleNamespace(length=0.1)
    scenario = SimpleNamespace(path=path, steered_on=steered_on)
    return SimpleNamespace(setup=SimpleNamespace(scenario=scenario), distance=distance)


def test_a_miss_of_single_strokes_that_adds_up_is_told_before_walking():
    twists = IdentifiedTwists({"a": measured("1", 0.015), "b": measured("12", 0.5)})
    require_holding(
        walk(0.33), "identified", lambda: twists, {"1"}
    )  # 4.95 % of the path
    require_holding(walk(9.0), "identified", lambda: twists, {"2"})  # not measured
    require_holding(walk(9.0), "quasi_static", lambda: twists, {"1"})
    require_holding(walk(9.0, "identified"), "identified", lambda: twists, {"1"})
    with pytest.raises(MeasurementError, match="could add up to 5 % of the path"):
        require_holding(walk(0.34), "identified", lambda: twists, {"1"})
