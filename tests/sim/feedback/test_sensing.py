"""Simulated sensors err as they are declared to, and only as often."""

from math import radians, sqrt

import numpy as np
import pytest

from sim.errors import UsageError
from sim.feedback.filter import Feedback
from sim.feedback.sensing import KINDS, Sensing, Sensor, sensing_of
from sim.scenarios.file import load_scenario

WILD = (0.1, 0.1, 0.5)  # how far a wild reading is off at most [m], [m], [rad]

POSE = np.tile([1.0, 2.0, 3.0], (4000, 1))


def readings(stops=1, **numbers):
    sensor = Sensor(Sensing(**numbers), np.random.default_rng(1), (len(POSE),))
    return np.array([sensor.read(POSE, 4.0) for _ in range(stops)])


def test_readings_scatter_as_declared_and_less_where_several_are_averaged():
    off = readings(position=2e-3, yaw=0.02, readings=4)[0, :, :3] - POSE
    # 4000 numbers: standard deviations are known to 1.1 %
    assert off.std(axis=0) == pytest.approx([1e-3, 1e-3, 0.01], rel=0.05)
    assert off.mean(axis=0) == pytest.approx(0.0, abs=0.01 / sqrt(4000) * 4)


def test_exact_readings_are_the_pose():
    assert (readings()[0, :, :3] == POSE).all()
    assert np.isnan(readings()[0, :, 3]).all()


def test_readings_come_every_so_many_stops_and_end_after_some():
    told = ~np.isnan(readings(stops=7, every=2, until=5)[:, 0, 0])
    assert told.tolist() == [False, True, False, True, False, False, False]


def test_some_readings_are_lost_and_some_are_wild():
    lost = np.isnan(readings(lost=0.3)[0, :, 0])
    assert lost.mean() == pytest.approx(0.3, abs=0.03)  # 4 standard deviations
    off = readings(wild=0.2)[0, :, :3] - POSE
    assert (off != 0).any(axis=1).mean() == pytest.approx(0.2, abs=0.03)
    assert (np.abs(off) <= WILD).all()
    assert np.abs(off).max(axis=0) == pytest.approx(WILD, rel=0.02)


def test_a_gyroscope_drifts_with_the_root_of_time_and_with_its_rate():
    walk = readings(stops=9, position=np.inf, yaw=np.inf, gyro_noise=1e-3)[-1]
    assert np.isnan(walk[:, :3]).all()
    assert (walk[:, 3] - 3.0).std() == pytest.approx(1e-3 * sqrt(36.0), rel=0.05)
    rate = readings(stops=9, gyro_noise=0.0, gyro_drift=1e-3)[-1]
    assert (rate[:, 3] - 3.0).std() == pytest.approx(1e-3 * 36.0, rel=0.05)


def test_a_scenario_names_a_kind_and_replaces_its_numbers():
    asked = {"sense": "tag", "sense_yaw": 0.5, "sense_until": 20, "gyro_noise": 1e-3}
    found = sensing_of(load_scenario("line", asked))
    assert (found.position, found.yaw) == (2e-3, 0.5)
    assert (found.until, found.gyro_noise) == (20, 1e-3)
    assert sensing_of(load_scenario("line")).is_exact
    assert KINDS["tag"].yaw == radians(1)


def test_a_kind_of_sensor_that_there_is_not_is_refused():
    with pytest.raises(UsageError, match="sense = 'lidar' is not allowed"):
        load_scenario("line", {"sense": "lidar"})


@pytest.mark.parametrize("pose", [[np.inf, 0.0, 0.0], [5.0], 5.0])
def test_a_reading_that_is_no_pose_is_refused(pose):
    """It would make all that is thought afterwards no number, or three times itself."""
    feedback = Feedback(KINDS["tag"], 0.1)
    with pytest.raises(ValueError, match="is not x, y .* and yaw"):
        feedback.seen(pose)
    assert np.isfinite(feedback.pose).all()


@pytest.mark.parametrize("value", [-1.0, np.nan])
def test_a_sensor_cannot_err_by_less_than_nothing(value):
    with pytest.raises(ValueError, match="position is .*; give 0 or more"):
        Sensing(position=value)


@pytest.mark.parametrize(
    ("numbers", "remedy"),
    [
        ({"position": -1.0}, "position is -1.0; give 0 or more"),
        ({"lost": 2}, "lost is 2; give a share from 0 to 1"),
        ({"wild": 1.1}, "wild is 1.1; give a share from 0 to 1"),
        ({"readings": 0}, "readings is 0; give a whole number from 1"),
        ({"every": 1.5}, "every is 1.5; give a whole number from 1"),
    ],
    ids=str,
)
def test_sensors_that_do_not_exist_are_refused(numbers, remedy):
    with pytest.raises(ValueError, match=remedy):
        Sensing(**numbers)
