"""Whether a rank depends on units is asked of fields that are known exactly."""

from types import SimpleNamespace

import numpy as np

from planner.controllability.gaits import _depends_on_units
from planner.systems.fields import NumericField


def test_rates_by_differences_tell_nothing_of_units():
    """What should be zero is their error, which other units would make a direction."""
    found = SimpleNamespace(fields=[], columns=np.diag([1.0, 1e-15]), rank=1)
    assert _depends_on_units(found)
    found.fields = [object.__new__(NumericField)]
    assert not _depends_on_units(found)
