"""How large numbers and files of a run may be, and how sure 90 % are."""

from math import log, sqrt

import pytest

from sim.runs.arrays import plain_json
from sim.runs.run import SURE


def test_numbers_of_a_summary_are_below_a_billion():
    assert plain_json(b'{"a": 9.9e8}') == {"a": 9.9e8}
    for large in (b"1.0e9", b"-1.1e9", b"Infinity"):
        with pytest.raises(ValueError, match="is not a number below 1e\\+09"):
            plain_json(b'{"a": %s}' % large)


def test_nine_of_ten_points_of_a_plane_are_as_near_as_the_circle_of_feedback():
    """Of two standard normal coordinates, 1 - exp(-r^2 / 2) lie within r."""
    assert pytest.approx(sqrt(-2 * log(0.1)), abs=1e-3) == SURE
