"""A measured prediction is left out of a walk for which it does not hold."""

import numpy as np
import pytest

from sim.evaluation.deviations import Scale, does_not_hold


@pytest.mark.parametrize(
    ("identified", "usual", "said"),
    [
        (0.019, 0.001, ""),  # within 2 %
        (0.05, 0.03, ""),  # hardly worse than the other
        (0.08, 0.008, "8.0 % of the path off this walk, and the quasi-static one 0.8"),
    ],
)
def test_a_measured_prediction_is_left_out_where_it_is_worse_than_others(
    identified, usual, said
):
    scale, still = Scale("quasi_static", 0.2, 1.0), np.zeros((3, 3))
    off = np.array([0.0, 1.0, 0.0])
    poses = {
        "achieved": still,
        "identified": still + identified * off,
        "quasi_static": still + usual * off,
    }
    found = does_not_hold(scale, "identified", poses)
    assert said in found
    assert bool(found) == bool(said)
