"""One segment and one reading by the equations of Kalman, written out."""

import numpy as np
import pytest

from sim.feedback.filter import (
    DRIFT,
    LOWER,
    OFFSET,
    POSE,
    STATES,
    STRANGE,
    Feedback,
    Learnt,
    Misses,
    bound,
)
from sim.feedback.sensing import Sensing
from sim.feedback.stops import read

CAMERA = Sensing(position=2e-3, yaw=0.02, gyro_noise=3e-3, gyro_drift=4e-3)
MISSES = Misses(
    bias=np.array([0.01, 0.02, 0.03]),
    slope=np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9]]),
    scatter=np.array([0.011, 0.012, 0.013]),
    wander=np.array([0.021, 0.022, 0.023]),
)
RADIUS = 0.2
WIDE = np.diag([0.02, 0.02, 0.05]) ** 2  # of a bias of which hardly anything is known


def some(seed=1, **changes):
    """Feedback with a covariance in which everything hangs together."""
    rng = np.random.default_rng(seed)
    feedback = Feedback(CAMERA, RADIUS, MISSES)
    root = rng.normal(size=(STATES, STATES)) * 1e-3
    feedback.covariance = root @ root.T
    feedback.pose = np.array([0.1, -0.2, 0.7])
    for name, value in changes.items():
        setattr(feedback, name, value)
    return feedback


def test_misses_are_expected_as_shares_of_the_radius():
    """Lengths in m; A leads from motions to misses, both of which have a yaw."""
    feedback = Feedback(CAMERA, RADIUS, MISSES)
    first = np.sqrt(np.diagonal(feedback.covariance))
    assert (first[POSE] == 0).all()
    assert first[3:6] == pytest.approx([0.01 * RADIUS, 0.02 * RADIUS, 0.03])
    scale = np.array([[1, 1, RADIUS], [1, 1, RADIUS], [1 / RADIUS, 1 / RADIUS, 1]])
    assert first[6:15] == pytest.approx((MISSES.slope * scale).ravel())
    assert first[OFFSET] == 0
    assert first[DRIFT] == 4e-3
    assert feedback.covariance == pytest.approx(np.diag(first**2))
    assert feedback.scatter == pytest.approx([0.011 * RADIUS, 0.012 * RADIUS, 0.013])


def test_a_segment_adds_scatter_in_its_frame_and_what_wanders():
    feedback = some(covariance=np.zeros((STATES, STATES)))
    feedback.moved([0.01, 0.0, 0.1], seconds=3.0)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    scatter = turn @ np.diag(feedback.scatter**2) @ turn.T
    wander = (MISSES.wander * [RADIUS, RADIUS, 1.0]) ** 2
    added = np.zeros((STATES, STATES))
    added[POSE, POSE] = scatter
    added[range(3, 6), range(3, 6)] = wander
    added[OFFSET, OFFSET] = 3e-3**2 * 3.0
    assert feedback.covariance == pytest.approx(added, abs=1e-18)


def test_a_gyroscope_that_is_not_there_adds_nothing():
    blind = Feedback(Sensing(position=2e-3, yaw=0.02), RADIUS, MISSES)
    blind.moved([0.01, 0.0, 0.0], seconds=3.0)
    assert blind.covariance[OFFSET, OFFSET] == 0
    assert blind.gyro.tolist() == [0.0, 0.0]


def test_the_rate_of_a_gyroscope_moves_its_offset_by_the_time():
    feedback = some(gyro=np.array([0.01, 2e-3]))
    feedback.moved([0.0, 0.0, 0.0], seconds=5.0)
    assert feedback.gyro == pytest.approx([0.02, 2e-3])
    feedback.moved([0.0, 0.0, 0.0])
    assert feedback.gyro == pytest.approx([0.022, 2e-3])  # of a second


def updated(feedback, rows, noise, off):
    """State and covariance after a reading, by the textbook."""
    P, H = feedback.covariance, np.zeros((len(rows), STATES))
    for row, states in enumerate(rows):
        H[row, list(states)] = 1.0
    S = H @ P @ H.T + np.diag(np.square(noise))
    gain = P @ H.T @ np.linalg.inv(S)
    parts = feedback.pose, feedback.bias, feedback.slope.ravel(), feedback.gyro
    state = np.concatenate(parts) + gain @ off
    return state, (np.eye(STATES) - gain @ H) @ P


def now(feedback):
    parts = feedback.pose, feedback.bias, feedback.slope.ravel(), feedback.gyro
    return np.concatenate(parts), feedback.covariance


@pytest.mark.parametrize("told", [[0, 1, 2], [0, 1], [2], [1]])
def test_a_reading_changes_all_that_hangs_together_with_what_it_tells(told):
    feedback, off = some(), np.array([1e-3, -2e-3, 0.01])
    noise = np.array([2e-3, 2e-3, 0.02])
    reading = np.where(np.isin(range(3), told), feedback.pose + off, np.nan)
    state, covariance = updated(feedback, [(k,) for k in told], noise[told], off[told])
    feedback.seen(reading)
    found, spread = now(feedback)
    assert found == pytest.approx(state, rel=1e-9, abs=1e-12)
    assert spread == pytest.approx(covariance, rel=1e-6, abs=1e-14)
    assert (spread == spread.T).all()


def test_a_gyroscope_tells_yaw_and_offset_together():
    feedback = some(gyro=np.array([0.05, 0.0]))
    state, covariance = updated(feedback, [(2, OFFSET)], [1e-12], np.array([0.02]))
    feedback.seen(gyro=0.7 + 0.05 + 0.02 - 2 * np.pi)
    found, spread = now(feedback)
    assert found == pytest.approx(state, rel=1e-6, abs=1e-9)
    assert spread == pytest.approx(covariance, abs=1e-9)


def test_yaw_is_compared_by_the_nearer_way_round():
    one, other = some(), some()
    one.seen([0.1, -0.2, 0.71])
    other.seen([0.1, -0.2, 0.71 + 2 * np.pi])
    assert other.pose == pytest.approx(one.pose)


@pytest.mark.parametrize("share", [0.9, 1.5, 4.0])
def test_a_reading_beyond_99_percent_counts_by_the_square_of_how_far(share):
    """Chi-squared of three numbers is below 11.345 with 99 %."""
    feedback, noise = some(), np.array([2e-3, 2e-3, 0.02])
    total = feedback.covariance[POSE, POSE] + np.diag(noise**2)
    way = np.array([1.0, 0.5, 3.0])
    off = way * np.sqrt(share * 11.345 / (way @ np.linalg.solve(total, way)))
    state, covariance = updated(
        feedback, [(0,), (1,), (2,)], noise * max(share, 1.0), off
    )
    feedback.seen(feedback.pose + off)
    found, spread = now(feedback)
    assert found == pytest.approx(state, rel=1e-9, abs=1e-12)
    assert spread == pytest.approx(covariance, rel=1e-6, abs=1e-14)


FAR, NEAR, LOST = [0.5, 0.4, 0.9], [0.0, 0.0, 0.0], [np.nan] * 3


@pytest.mark.parametrize(
    ("readings", "moved"),
    [
        ([FAR, FAR], False),
        ([FAR, FAR, FAR], True),
        ([FAR, NEAR, FAR, FAR], False),  # one in between is no row
        ([FAR, LOST, FAR, LOST, FAR], True),  # but one that is lost is none
        ([FAR, FAR, FAR, NEAR, NEAR], True),  # counted anew
    ],
)
def test_three_strange_readings_in_a_row_mean_that_it_was_moved(readings, moved):
    feedback = Feedback(Sensing(position=1e-3, yaw=0.01), RADIUS)
    for reading in readings:
        feedback.moved(np.zeros(3))
        feedback.seen(reading)
    near = feedback.pose == pytest.approx(np.array(FAR), rel=0.02)
    assert near == moved
    assert STRANGE == 3


def test_a_robot_that_was_moved_is_as_uncertain_as_it_is_off():
    feedback = some()
    feedback._strange = np.array(2)
    off = np.array([0.3, -0.2, 0.5])
    wide = some()
    wide.covariance = wide.covariance.copy()
    wide.covariance[range(3), range(3)] += off**2
    state, covariance = updated(wide, [(0,), (1,), (2,)], [2e-3, 2e-3, 0.02], off)
    feedback.seen(feedback.pose + off)
    found, spread = now(feedback)
    assert found == pytest.approx(state, rel=1e-8)
    assert spread == pytest.approx(covariance, rel=1e-5, abs=1e-12)
    assert feedback._strange == 0


def test_many_walks_are_followed_as_each_alone():
    rng = np.random.default_rng(2)
    many = Feedback(CAMERA, RADIUS, MISSES, batch=(4,))
    ones = [Feedback(CAMERA, RADIUS, MISSES) for _ in range(4)]
    for _ in range(5):
        meant = rng.normal(size=(4, 3)) * 0.01
        poses, gyro = rng.normal(size=(4, 3)) * 0.03, rng.normal(size=4) * 0.03
        many.moved(meant, 2.0)
        many.seen(poses, gyro)
        for k, one in enumerate(ones):
            one.moved(meant[k], 2.0)
            one.seen(poses[k], gyro[k])
    for k, one in enumerate(ones):
        for name in ("pose", "bias", "slope", "gyro", "covariance", "claimed"):
            assert getattr(many, name)[k] == pytest.approx(
                getattr(one, name), abs=1e-12
            )
        target = [0.02, 0.01, 0.1]
        assert many.aim(target)[k] == pytest.approx(one.aim(target))


@pytest.mark.parametrize("low", [0.9e-12, -0.9e-12, -1.1e-12])
def test_a_covariance_may_be_singular_but_for_rounding(low):
    half = np.diag([low, *np.ones(11)])
    numbers = (*np.zeros(12), *half[LOWER])
    if low < -1e-12:
        with pytest.raises(ValueError, match="positive semidefinite"):
            Learnt.of(numbers)
    else:
        assert Learnt.of(numbers).covariance == pytest.approx(half)


def test_the_bound_counts_readings_and_scatter_and_the_time_of_a_gyroscope():
    """Yaw is known from the gyroscope, whose error grows with the time."""
    seen = np.full((6, 4), np.nan)
    seen[:, 3] = 0.0
    sensing = Sensing(position=np.inf, yaw=np.inf, gyro_noise=1e-3)
    scatter = np.array([1e-4, 1e-4, 0.5])
    still = np.zeros((6, 3))
    _, yaw = bound(sensing, still, seen, scatter, np.full(6, 4.0), WIDE)
    # five readings of a random walk; the miss of one more segment is known no better
    grown = 1e-3 * np.sqrt(5 * 4.0)
    assert yaw > 0.5
    near = np.zeros(3)
    _, known = bound(sensing, still, seen, near, np.full(6, 4.0), WIDE)
    assert known < 0.5 * 0.05
    assert known > 0.2 * grown


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("0,1.0,", "1,1.0,", "impossible stop 0"),
        ("0,1.0,", "0,1e9,", "impossible stop 0"),
        ("0,1.0,", "0,-1e9,", "impossible stop 0"),
        ("0,1.0,", "0,9e8,", ""),
    ],
)
def test_stops_are_numbered_and_below_a_thousand_million(old, new, said):
    from sim.feedback.stops import COLUMNS

    text = (
        ",".join(COLUMNS) + "\n0,1.0," + ",".join(["0.5"] * (len(COLUMNS) - 2)) + "\n"
    )
    assert text.count(old) == 1
    changed = text.replace(old, new)
    if said:
        with pytest.raises(ValueError, match=said):
            read(changed)
    else:
        assert read(changed)[0].time == 9e8


@pytest.mark.parametrize("radius", [0.0, -0.1, np.nan, np.inf])
def test_feet_are_at_a_distance_from_the_middle(radius):
    with pytest.raises(ValueError, match="radius is .*; give a distance beyond 0"):
        Feedback(Sensing(), radius)


@pytest.mark.parametrize(
    ("call", "given", "said"),
    [
        ("moved", ([np.nan, 0.0, 0.0],), "the step .* is not x, y .m. and yaw"),
        ("moved", ([0.0, np.inf, 0.0],), "the step .* is not x, y .m. and yaw"),
        ("moved", ([0.1, 0.0],), "the step .* is not x, y .m. and yaw"),
        ("moved", ([[[0.1, 0.0, 0.0]]],), "dimensions"),
        ("moved", ([0.1, 0.0, 0.0], np.nan), "a step of nan s; give the time"),
        ("moved", ([0.1, 0.0, 0.0], np.inf), "a step of inf s; give the time"),
        ("moved", ([0.1, 0.0, 0.0], -1.0), "a step of -1.0 s; give the time"),
        ("aim", ([np.nan, 0.0, 0.0],), "the target .* is not x, y .m. and yaw"),
        ("aim", (0.1,), "the target 0.1 is not x, y .m. and yaw"),
        ("seen", ([1e154, 0.0, 0.0],), "is not x, y .m. and yaw"),
    ],
)
def test_what_is_no_motion_is_refused_and_changes_nothing(call, given, said):
    feedback = Feedback(CAMERA, RADIUS, MISSES)
    before = feedback.pose.copy(), feedback.claimed
    with pytest.raises(ValueError, match=said):
        getattr(feedback, call)(*given)
    assert np.array_equal(feedback.pose, before[0])
    assert np.array_equal(feedback.claimed, before[1])
