"""Makes of servo by the names that are written on them and on their data sheets."""

import pytest

from models.description import KNOWN_SERVOS, servo_of


@pytest.mark.parametrize(
    ("written", "make"),
    [("9g", "sg90"), ("MG90S", "mg90"), ("MG996", "mg996r"), ("LX16A", "lx-16a")],
)
def test_a_make_is_known_by_what_is_written_on_it(written, make):
    assert servo_of(written) == KNOWN_SERVOS[make]
    assert written.lower() not in KNOWN_SERVOS  # so that lists name each make once
