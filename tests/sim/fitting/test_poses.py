"""What a fit to poses says of settings, which are functions of what it estimates."""

from dataclasses import replace

import numpy as np
import pytest

from models import load
from sim.cli import main
from sim.fitting.estimate import Estimates
from sim.fitting.poses import (
    BODY,
    SETTINGS,
    PoseFit,
    _changed,
    log_of,
    walked_of_log,
    walked_of_run,
)
from sim.logs.log import read_log
from sim.logs.playing import scenario_of
from sim.preparation.setup import prepare
from sim.runs.run import read_run
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


@pytest.fixture(scope="module")
def setup_and_log(tmp_path_factory):
    """A gait that is played on the shipped hexapod, and its log with a body at rest."""
    file = tmp_path_factory.mktemp("gait") / "log.csv"
    motion(file, amplitude=0.2, turn=0.3, periods=1)
    robot = load(ROBOT)
    log = read_log(file, robot.card.joints, robot.legs, "radians")
    setup = prepare(scenario_of(robot, file, {}), robot, log=log)
    return setup, replace(log, pose=np.zeros((len(log.time), 3)))


@pytest.fixture(scope="module")
def gait(setup_and_log):
    return walked_of_log(*setup_and_log)


def test_a_log_begins_where_the_robot_has_stood_for_its_hold(setup_and_log, gait):
    setup, log = setup_and_log
    (pose,) = gait.follow(gait.expected[None])
    assert pose[0] == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.abs(pose).max() > 1e-3  # [m], and it walks from then on
    assert gait.times == pytest.approx(setup.limits.hold + log.time, abs=1e-9)


def test_rows_in_which_no_pose_was_measured_say_nothing(setup_and_log, gait):
    setup, log = setup_and_log
    gaps = np.arange(len(log.time)) % 3 == 1
    pose = np.where(gaps[:, None], np.nan, log.pose)
    found = walked_of_log(setup, replace(log, pose=pose))
    np.testing.assert_array_equal(found.times, gait.times[~gaps])
    assert np.isfinite(found.pose).all()


@pytest.mark.parametrize("lacks", ["a pose", "most of it", "a column", "a motion"])
def test_a_log_without_its_poses_says_which_columns_are_missing(setup_and_log, lacks):
    setup, log = setup_and_log
    if lacks == "a motion":
        setup = replace(setup, motion=None)
    else:
        gap = np.where(np.arange(len(log.time)) % 3, np.nan, 0.0)
        column = log.pose * [1.0, 1.0, np.nan]
        poses = {"a pose": None, "most of it": log.pose + gap[:, None]}
        log = replace(log, pose=(poses | {"a column": column})[lacks])
    with pytest.raises(ValueError, match=r"give body\.x, body\.y and body\.yaw in"):
        walked_of_log(setup, log)


def changed(gait, by):
    """A robot before and after values of some settings are changed."""
    values, old = gait.expected, gait.phases.robots
    for setting, more in by.items():
        values[SETTINGS[setting]] += more
    return old, _changed(old, values[None])


def test_a_robot_as_it_was_described_is_changed_in_nothing(gait):
    old, new = changed(gait, {})
    for name in ("friction", "mass", "body_mass", "body_center", "stiffness"):
        assert getattr(new, name)[0] == pytest.approx(getattr(old, name)[0], rel=1e-12)
    level = 2e-5 * 9.81  # a slope of 1e-5 stays, so that it has a direction
    assert new.gravity[0] == pytest.approx(old.gravity[0], abs=level)


def test_a_payload_adds_its_mass_and_its_moments(gait):
    old, new = changed(gait, {"payload": [0.1, 2e-3, -1e-3]})
    assert new.mass[0] - old.mass[0] == pytest.approx(0.1)
    assert new.body_mass[0] - old.body_mass[0] == pytest.approx(0.1)
    before, after = (robot.body_mass[0] * robot.body_center[0] for robot in (old, new))
    assert after - before == pytest.approx([2e-3, -1e-3, 0.0], abs=1e-12)


def test_a_slope_turns_gravity_and_leaves_its_size(gait):
    old, new = changed(gait, {"slope": [0.1, -0.2]})
    size = np.linalg.norm(old.gravity[0])
    assert np.linalg.norm(new.gravity[0]) == pytest.approx(size)
    assert new.gravity[0, :2] == pytest.approx([0.1 * size, -0.2 * size], rel=1e-3)
    assert new.gravity[0, 2] < 0


def test_friction_and_stiffness_keep_what_feet_and_joints_differ_by(gait):
    old, new = changed(gait, {"friction": 0.2, "servo_stiffness": 0.5})
    assert np.ptp(new.friction[0] - old.friction[0]) == pytest.approx(0, abs=1e-12)
    assert new.friction.mean() - old.friction.mean() == pytest.approx(0.2)
    stiffer = new.stiffness[0] / old.stiffness[0]
    assert stiffer == pytest.approx(np.full_like(stiffer, np.exp(0.5)))


def test_a_walk_and_its_log_show_the_same_moments(walked):
    run = read_run(walked)
    log, known = log_of(run), walked_of_run(run)
    assert log.time[0] == 0
    first = run.time[run.walking][0]
    assert known.times - log.time == pytest.approx(np.full_like(log.time, first))
    assert known.pose == pytest.approx(log.pose)


def test_a_run_of_another_robot_is_not_fitted(walked, capsys):
    assert main(["fit", "quadruped", str(walked)]) == 2
    assert f"by another robot than quadruped: {walked}" in capsys.readouterr().err


@pytest.mark.physics
def test_what_servos_add_to_commands_is_none_of_a_walk_s_log(tmp_path):
    """A run's commands have delay and zeros; whoever fits them has to see none."""
    goal = ["--set", "path.goal=[0.004,0,0]", "--set", 'predictions=["ideal"]']
    words = ["run", "line", "--segments", "1", "--no-video", *goal]
    own = ["--set", "command_delay=0.05", "--set", "zero_offset=0.02"]
    own += ["--tolerance", "9"]
    assert main([*words, "--out", str(tmp_path / "plain")]) == 0
    assert main([*words, *own, "--out", str(tmp_path / "late")]) == 0
    plain, late = (log_of(read_run(tmp_path / name)) for name in ("plain", "late"))
    # the last command of the walk is the last of its run, which the delay cuts short
    assert late.commanded[:-6] == pytest.approx(plain.commanded[:-6], abs=1e-9)
    follow = walked_of_run(read_run(tmp_path / "late"))
    off = follow.missed(follow.expected[None], len(follow.times))[0]
    # though it is late by 50 ms, which are millimetres while it moves
    assert np.sqrt((off**2).sum(axis=0).mean()) < 1e-4
    settled = np.abs(late.measured - plain.measured)[0]
    assert settled.max() > 0.005  # zeros are where the joints are
