"""Sensors as the page of feedback lists them, and what is expected of no other."""

import re
from dataclasses import fields
from math import degrees, inf
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from sim.feedback.filter import GATE, Feedback, Misses
from sim.feedback.sensing import KINDS, Sensing
from sim.feedback.stops import read, written
from tests.sim.feedback.test_foreign_stops import POSE, STOPS

PAGE = (Path(__file__).parents[3] / "docs" / "feedback.md").read_text()
TEXT = " ".join(PAGE.split())


@pytest.mark.parametrize("kind", ["mocap", "tag"])
def test_sensors_are_as_good_as_the_page_says(kind):
    row = next(x for x in PAGE.splitlines() if x.startswith(f"| `{kind}`"))
    position, yaw, delay = (
        float(n) for n in re.findall(r"([\d.]+) (?:mm|deg|ms)", row)
    )
    found = KINDS[kind]
    assert 1e3 * found.position == pytest.approx(position)
    assert degrees(found.yaw) == pytest.approx(yaw)
    assert 1e3 * found.delay == pytest.approx(delay)


def test_a_sensor_of_which_nothing_is_said_reads_the_pose_itself_at_every_stop():
    plain = Sensing()
    assert plain.is_exact
    assert plain.noise.tolist() == [0.0, 0.0, 0.0]
    assert (plain.readings, plain.every, plain.until) == (1, 1, None)
    assert plain.lost == plain.wild == plain.stop == plain.gyro_drift == 0
    assert plain.gyro_noise is None
    assert Sensing(position=0.0, yaw=0.01).is_exact is False
    assert Sensing(position=0.01).noise.tolist() == [0.01, 0.01, 0.0]
    assert {field.name for field in fields(Sensing)} >= {"readings", "every", "lost"}


def test_a_gyroscope_alone_sees_no_pose_and_drifts_as_the_page_says():
    gyro = KINDS["gyro"]
    assert gyro.position == gyro.yaw == inf
    assert f"error of {degrees(gyro.gyro_noise):.3f} degrees after 1 s" in TEXT
    assert gyro.gyro_drift == gyro.gyro_noise


def test_misses_are_expected_as_the_page_says():
    misses = Misses()
    bias, scatter = (f"{100 * x:g} % of $R$ and {1e3 * yaw:g} mrad" for x, yaw in (
        (misses.bias[0], misses.bias[2]), (misses.scatter[0], misses.scatter[2])
    ))  # fmt: skip
    assert f"{bias} for $b$, {misses.slope[0, 0]:g} for $A$, and {scatter} for" in TEXT
    assert misses.bias[0] == misses.bias[1]
    assert misses.scatter[0] == misses.scatter[1]
    assert (misses.slope[:2, :2] == misses.slope[0, 0]).all()


@pytest.mark.parametrize("number", [0.99e9, 1e9])
def test_numbers_of_a_stop_are_below_a_billion(number):
    changed = [STOPS[0], STOPS[1]._replace(thought=(number, *POSE[1:]))]
    if number < 1e9:
        assert len(read(written(changed))) == 2
    else:
        with pytest.raises(ValueError, match="impossible stop 1"):
            read(written(changed))


def test_readings_are_gated_that_are_farther_off_than_99_percent_of_all():
    assert pytest.approx(chi2.ppf(0.99, 3), abs=1e-3) == GATE


def test_a_segment_takes_a_second_unless_it_is_said_how_long_it_takes():
    sensing = Sensing(position=2e-3, yaw=0.02, gyro_noise=3e-3, gyro_drift=4e-3)
    plain, timed = (Feedback(sensing, 0.2, Misses()) for _ in range(2))
    plain.moved([0.01, 0.0, 0.1])
    timed.moved([0.01, 0.0, 0.1], seconds=1.0)
    assert np.array_equal(plain.covariance, timed.covariance)
