"""What a fit to poses says of settings, which are functions of what it estimates."""

from dataclasses import replace

import numpy as np
import pytest

from models import load
from sim.fitting.estimate import Estimates
from sim.fitting.poses import BODY, PoseFit, walked_of_log
from sim.logs.log import read_log
from sim.logs.playing import scenario_of
from sim.preparation.setup import prepare
from tests.sim.fitting.test_fitted_robot import ROBOT, motion


@pytest.fixture
def found():
    """Estimates that measurements determine each on its own."""
    value = np.array([[0.8, 0.5, 0.02, -0.03, 0.02, 0.01, np.log(40)]])
    sharp = 10 / np.array([p.spread for p in BODY])
    return Estimates(BODY, value, value, np.diag(sharp**2)[None], np.ones(1))


def carried(function, value, error):
    """Errors of a function of values that err on their own, to first order."""
    changes = [function(value + 1e-6 * row) - function(value) for row in np.diag(error)]
    return np.linalg.norm(changes, axis=0) / 1e-6


def test_errors_of_a_payload_s_place_are_those_of_its_mass_and_moments(found):
    (value,), (error,) = found.value, found.error
    (mass, x, y, z), (off, *errors, _) = PoseFit(found, 0.0, 0.0).settings["payload"]
    assert (mass, off, z) == pytest.approx((value[1], error[1], 0.0))
    assert (mass * x, mass * y) == pytest.approx(tuple(value[2:4]))
    place = carried(lambda v: v[2:4] / v[1], value, error)
    assert errors == pytest.approx(place, rel=1e-4)


def test_a_slope_errs_by_no_less_than_its_components_do(found):
    (value,), (error,) = found.value, found.error
    (steep, toward), errors = PoseFit(found, 0.0, 0.0).settings["slope"]
    ahead, left = steep * np.cos(toward), steep * np.sin(toward)
    assert (ahead, left) == pytest.approx(tuple(value[4:6]))
    told = [
        lambda v: np.hypot(v[4], v[5]),
        lambda v: np.arctan2(v[5], v[4]),
    ]
    for of, own in zip(told, errors, strict=True):
        least = carried(of, value, error)
        assert least <= own <= 1.5 * least  # 1.41 where components err alike


def test_a_log_begins_where_the_robot_has_stood_for_its_hold(tmp_path):
    file = tmp_path / "log.csv"
    motion(file, amplitude=0.2, turn=0.3, periods=1)
    robot = load(ROBOT)
    log = read_log(file, robot.card.joints, robot.legs, "radians")
    setup = prepare(scenario_of(robot, file, {}), robot, log=log)
    log = replace(log, pose=np.zeros((len(log.time), 3)))
    walked = walked_of_log(setup, log)
    (pose,) = walked.follow(walked.expected[None])
    assert pose[0] == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.abs(pose).max() > 1e-3  # [m], and it walks from then on
    assert walked.times == pytest.approx(setup.limits.hold + log.time, abs=1e-9)
