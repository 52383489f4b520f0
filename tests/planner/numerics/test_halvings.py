"""How short the pieces of a flow become before it is refused."""

import numpy as np
import pytest

from planner.errors import ConvergenceError
from planner.numerics import collocation
from planner.numerics.collocation import follow


def test_a_flow_is_halved_twelve_times_before_it_is_refused(monkeypatch):
    tried = []

    def never(field, x, durations, rule):
        tried.extend(durations)
        return np.full(x.shape, np.nan)

    monkeypatch.setattr(collocation, "_picard", never)
    with pytest.raises(ConvergenceError, match="flow for 8 from"):
        follow(lambda z: z, np.ones(2), 8.0)
    assert min(tried) == 8.0 / 2**12
