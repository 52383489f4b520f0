"""The filter is that of its model, claims what it errs, and learns from what it saw."""

from math import radians

import numpy as np
import pytest

from sim.feedback.filter import (
    NONE_MISSED,
    STATES,
    Feedback,
    Learnt,
    Misses,
    bound,
)
from sim.feedback.sensing import Sensing, Sensor
from sim.feedback.stops import Followed, stop_after
from sim.motion.poses import compose, wrap
from sim.scenarios.file import load_scenario

CAMERA = Sensing(position=2e-3, yaw=radians(1.0))
MEANT = np.array([4e-3, 1e-3, 0.02])
QUIET = Misses(scatter=np.zeros(3), wander=np.zeros(3))
TOLD_BY_NONE = np.full(3, np.nan)
WIDE = np.diag([0.02, 0.02, 0.05]) ** 2  # of a bias of which hardly anything is known


def at_a_pose(**changes):
    """Feedback in the middle of a walk, with all of its state different from 0."""
    feedback = Feedback(CAMERA, 0.2, QUIET)
    feedback.pose = np.array([0.1, -0.2, 0.7])
    feedback.bias = np.array([1e-3, -2e-3, 0.01])
    feedback.slope = np.array([[0.1, -0.05, 0.01], [0.02, 0.08, 0.0], [0.3, 0.1, 0.02]])
    for name, value in changes.items():
        setattr(feedback, name, value)
    return feedback


def state_of(feedback):
    parts = feedback.pose, feedback.bias, feedback.slope.ravel(), feedback.gyro
    return np.concatenate(parts)


def moved_from(state):
    pose, bias, slope, gyro = np.split(state, [3, 6, 15])
    feedback = at_a_pose(pose=pose, bias=bias, slope=slope.reshape(3, 3), gyro=gyro)
    feedback.moved(MEANT, seconds=2.0)
    return state_of(feedback)


@pytest.mark.parametrize("state", range(STATES))
def test_uncertainty_is_carried_along_as_the_motion_carries_differences(state):
    step = 1e-6 * np.eye(STATES)[state]
    here = state_of(at_a_pose())
    slope = (moved_from(here + step) - moved_from(here - step)) / 2e-6
    feedback = at_a_pose(covariance=np.diag(np.eye(STATES)[state]))
    feedback.moved(MEANT, seconds=2.0)
    # central differences of a smooth motion err by about 1e-10
    assert feedback.covariance == pytest.approx(np.outer(slope, slope), abs=1e-8)


def test_what_is_aimed_at_is_what_is_expected():
    feedback, target = at_a_pose(), np.array([0.104, -0.198, 0.72])
    meant = feedback.aim(target)
    expected = compose(feedback.pose, meant + feedback.missing(meant))
    assert expected == pytest.approx(target, abs=1e-15)


def test_a_target_across_half_a_turn_is_the_nearer_way_round():
    feedback = at_a_pose(pose=np.array([0.0, 0.0, 3.14]), slope=np.zeros((3, 3)))
    feedback.bias = np.zeros(3)
    assert feedback.aim([0.0, 0.0, -3.13])[2] == pytest.approx(2 * np.pi - 6.27)


def walks_of_its_own_model(count, segments, sensing, misses=None):
    """Robots that miss as the filter expects; its error over claim, by segment."""
    misses = Misses() if misses is None else misses
    random, unit = np.random.default_rng(3), np.array([0.2, 0.2, 1.0])
    feedback = Feedback(sensing, 0.2, misses, batch=(count,))
    sensor = Sensor(sensing, random, (count,))
    bias = random.normal(size=(count, 3)) * misses.bias * unit
    slope = random.normal(size=(count, 3, 3)) * misses.slope * np.outer(unit, 1 / unit)
    pose, errors = np.zeros((count, 3)), []
    for k in range(segments):
        turning = 2 * np.pi * k / segments
        meant = np.array([4e-3 * np.cos(turning), 4e-3 * np.sin(turning), 0.0])
        miss = bias + slope @ meant
        miss = miss + random.normal(size=(count, 3)) * misses.scatter * unit
        bias = bias + random.normal(size=(count, 3)) * misses.wander * unit
        pose = compose(pose, meant + miss)
        feedback.moved(meant, 6.0)
        told = sensor.read(pose, 6.0)
        feedback.seen(told[..., :3], told[..., 3])
        off = feedback.pose - pose
        off[:, 2] = wrap(off[:, 2])
        errors.append((off, feedback.covariance[:, :3, :3]))
    return errors


@pytest.mark.parametrize(
    "sensing",
    [CAMERA, Sensing(position=2e-3, yaw=1.0, gyro_noise=4e-4, gyro_drift=1e-3)],
    ids=["camera", "poor camera and gyroscope"],
)
def test_of_robots_that_miss_as_it_expects_it_claims_what_it_errs(sensing):
    ratios = [
        np.einsum("ni,nij,nj->n", off, np.linalg.inv(spread), off).mean()
        for off, spread in walks_of_its_own_model(400, 20, sensing)[5:]
    ]
    # three degrees of freedom; the gate and the turn's curvature leave 5 %
    assert np.mean(ratios) == pytest.approx(3.0, rel=0.05)


def test_exact_readings_are_the_pose_and_a_constant_miss_is_learnt_in_one_segment():
    feedback = Feedback(Sensing(), 0.2, Misses(slope=np.zeros((3, 3))))
    missed = np.array([2e-3, -1e-3, 5e-3])
    pose = compose(np.zeros(3), MEANT + missed)
    feedback.moved(MEANT)
    feedback.seen(pose)
    assert (feedback.pose == pose).all()
    # scatter is thought to be 15 times smaller than a bias may be, and 8 in yaw
    assert feedback.bias == pytest.approx(missed, rel=0.02)


def test_nothing_is_learnt_from_what_was_not_seen():
    feedback = at_a_pose()
    before, doubt = state_of(feedback)[3:], feedback.claimed
    for _ in range(3):
        feedback.moved(MEANT)
        feedback.seen(TOLD_BY_NONE, np.nan)
    assert (state_of(feedback)[3:15] == before[:12]).all()
    assert (feedback.claimed[:2] > doubt[:2]).all()


def test_nothing_is_learnt_from_what_infinite_noise_tells():
    gyro, camera = (Feedback(Sensing(position=np.inf, yaw=np.inf), 0.2) for _ in "12")
    for feedback in (gyro, camera):
        feedback.moved(MEANT)
    camera.seen([0.02, -0.01, 0.3])
    assert (camera.covariance == gyro.covariance).all()
    assert (state_of(camera) == state_of(gyro)).all()


def test_a_camera_without_yaw_tells_the_position():
    feedback = Feedback(Sensing(position=1e-3, yaw=np.inf), 0.2)
    feedback.moved(MEANT)
    feedback.seen([6e-3, 1e-3, np.nan])
    assert 4e-3 < feedback.pose[0] < 6e-3
    assert feedback.pose[2] == pytest.approx(0.02, abs=1e-3)


def after(readings, **noise):
    """Feedback that has settled on a still robot, and is then told some readings."""
    feedback = Feedback(Sensing(position=1e-3, yaw=0.01, **noise), 0.2)
    for reading in [np.zeros(3)] * 30 + readings:
        feedback.moved(np.zeros(3))
        feedback.seen(reading)
    return feedback


def test_a_wild_reading_hardly_counts():
    wild = np.array([0.08, -0.05, 0.3])
    alone = after([wild])
    # variance grows with the fourth power of the distance: 80 standard deviations off
    assert np.abs(alone.pose[:2]).max() < 0.1e-3


def test_after_three_readings_in_a_row_the_robot_was_moved_and_what_it_misses_is_kept():
    there = np.array([0.02, -0.01, 0.09])
    bias = after([]).bias
    moved = after([there] * 3)
    # the pose before three such readings was thought known to a tenth of that
    assert moved.pose == pytest.approx(there, rel=0.05)
    # a sixth of what it would learn if it were told to have walked there
    assert np.abs(moved.bias - bias)[:2].max() < 2e-3


def test_a_reading_within_reason_is_not_gated():
    near, same = after([np.array([1e-3, 0.0, 0.0])]), after([np.zeros(3)])
    assert near.pose[0] > same.pose[0] + 0.2e-3


def test_a_gyroscope_tells_the_yaw_alone_and_position_grows_uncertain():
    sensing = Sensing(position=np.inf, yaw=np.inf, gyro_noise=1e-4)
    feedback, doubts = Feedback(sensing, 0.2), []
    for _ in range(20):
        feedback.moved(np.array([4e-3, 0.0, 0.0]))
        feedback.seen(gyro=feedback.pose[2])
        doubts.append(feedback.claimed)
    across, yaw = np.array(doubts)[:, :2], np.array(doubts)[:, 2]
    assert (np.diff(across, axis=0) > 0).all()
    assert yaw.max() < 1e-3


def test_what_was_learnt_is_read_again_as_it_was_written():
    feedback = after([np.array([1e-3, 2e-3, 0.01])])
    learnt = Learnt.of(feedback.learnt.numbers)
    again = Feedback(CAMERA, 0.2, learnt=learnt)
    assert (again.bias == feedback.bias).all()
    assert (again.slope == feedback.slope).all()
    assert again.covariance[3:15, 3:15] == pytest.approx(
        feedback.covariance[3:15, 3:15], rel=1e-12, abs=1e-20
    )
    assert (again.claimed == 0).all()  # where the next walk starts is known


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ((0.0,) * 89, "90 numbers are needed, got 89"),
        ((np.nan,) * 90, "finite numbers"),
        ((10.1,) + (0.0,) * 89, "none beyond 10"),
        ((0.0,) * 12 + (np.inf,) + (0.0,) * 77, "finite numbers"),
        ((0.0,) * 3 + (*-np.eye(3).ravel(),) + (0.0,) * 78, "less than 10% of a segm"),
        ((0.0,) * 12 + (-1.0,) * 78, "positive semidefinite"),
    ],
)
def test_what_cannot_have_been_learnt_is_refused(numbers, message):
    with pytest.raises(ValueError, match=message):
        Learnt.of(numbers)


def test_what_a_small_robot_has_hardly_seen_is_learnt_again():
    """Where its feet are 20 mm from its middle, a radian a metre is no large one."""
    seen = Feedback(CAMERA, 0.02).learnt.numbers
    assert max(seen) > 10
    assert Learnt.of(seen).numbers == seen
    plain = {"replan": True, "sense": "tag", "learnt": list(seen)}
    assert load_scenario("line", plain).learnt == seen


def test_the_bound_is_that_of_a_straight_line_through_readings_of_a_constant_miss():
    """Without scatter or turning, p_k = k b: its variance at n is n^2 s^2 / sum k^2."""
    n, deviation = 12, 1e-5
    sensing = Sensing(position=deviation, yaw=1e-7)
    seen = np.zeros((n, 4))
    seen[:, 3] = np.nan
    found, _ = bound(sensing, np.zeros((n, 3)), seen, np.zeros(3), np.ones(n), WIDE)
    alone = n * deviation / np.sqrt((np.arange(1, n) ** 2).sum())
    assert found == pytest.approx(np.sqrt(2) * alone, rel=1e-4)


def test_a_bound_takes_no_reading_that_was_lost():
    seen = np.full((10, 4), np.nan)
    scatter, meant = np.full(3, 1e-4), np.tile(MEANT, (10, 1))
    blind, _ = bound(CAMERA, meant, seen, scatter, np.ones(10), WIDE)
    seen[4, :3] = 0.0
    once, _ = bound(CAMERA, meant, seen, scatter, np.ones(10), WIDE)
    assert once < 0.5 * blind


@pytest.mark.parametrize("segments", [1, 2, 12])
@pytest.mark.parametrize("learnt", [False, True])
def test_no_filter_claims_less_than_the_bound_whatever_it_knew_beforehand(
    learnt, segments
):
    """It does not know A, and errs by as much where this makes no difference."""
    spread = np.random.default_rng(1).normal(size=(12, 12)) * 1e-4
    known = Learnt(np.zeros(3), np.zeros((3, 3)), spread @ spread.T) if learnt else None
    feedback = Feedback(CAMERA, 0.2, Misses(wander=np.zeros(3)), known)
    meant, seen = np.tile(MEANT, (segments, 1)), np.full((segments, 4), np.nan)
    seen[:, :3] = 0.0
    for motion in meant:
        feedback.moved(motion)
        claimed = np.hypot(*feedback.claimed[:2]), feedback.claimed[2]
        feedback.seen(feedback.pose)
    told = CAMERA, meant, seen, feedback.scatter, np.ones(segments)
    least = bound(*told, feedback.foreknown)
    assert (np.array(claimed) >= least).all()
    if not learnt:
        assert claimed == pytest.approx(least, rel=0.15)


def test_what_a_filter_that_learns_nothing_takes_for_certain_is_not_foreknown():
    """It assumes that segments miss nothing, and the robot's may miss much."""
    stops = []
    for learns in (True, False):
        misses = Misses() if learns else NONE_MISSED
        feedback = Feedback(CAMERA, 0.2, misses)
        told = (0, 1.0, 1.0, MEANT, np.append(MEANT, np.nan), MEANT)
        stops.append(Followed((stop_after(feedback, *told),), feedback, learns).bound)
    (near, _), (far, _) = stops
    assert near < 0.3 * far
    assert far == pytest.approx(0.02 * np.sqrt(2), rel=0.02)
