"""What a walk saw and thought is written, read again, and judged by its bound."""

import numpy as np
import pytest

from sim.feedback.filter import Feedback
from sim.feedback.sensing import Sensing, Sensor
from sim.feedback.stops import Followed, read, stop_after, written
from sim.motion.poses import compose

CAMERA = Sensing(position=2e-3, yaw=0.02, lost=0.2)
MISSED = np.array([2e-3, -1e-3, 5e-3])
SCATTER = np.array([2e-4, 2e-4, 1e-3])


def followed(seed, segments=30):
    """A walk of a robot that misses the same in every segment, but for scatter."""
    random = np.random.default_rng(seed)
    feedback, sensor = Feedback(CAMERA, 0.2), Sensor(CAMERA, random)
    pose, stops = np.zeros(3), []
    for k in range(segments):
        meant = feedback.aim([4e-3 * (k + 1), 0.0, 0.0])
        pose = compose(pose, meant + MISSED + random.normal(size=3) * SCATTER)
        told = sensor.read(pose, 6.0)
        stops.append(stop_after(feedback, k, 6.0 * (k + 1), 6.0, meant, told, pose))
    return Followed(tuple(stops), feedback, learns=True)


def test_stops_are_read_as_they_were_written_with_gaps_where_nothing_was_told():
    stops = followed(0).stops
    again = read(written(stops))
    assert any(np.isnan(stop.seen[0]) for stop in stops)
    for one, other in zip(stops, again, strict=True):
        for name in one._fields:
            assert np.array_equal(
                getattr(one, name), getattr(other, name), equal_nan=True
            )


def test_a_text_that_lacks_a_column_or_an_entry_is_refused():
    header, first, *_ = written(followed(0).stops).splitlines()
    with pytest.raises(KeyError, match="doubt_x"):
        read("\n".join([header.replace("doubt_x", "other"), first]))
    with pytest.raises(ValueError, match="is incomplete"):
        read("\n".join([header, first + ",1"]))


def test_a_walk_ends_as_near_as_the_bound_lets_it_and_no_nearer_in_the_mean():
    walks = [followed(seed) for seed in range(40)]
    ends = [np.subtract(w.stops[-1].expected, w.stops[-1].true) for w in walks]
    rms = np.sqrt(np.mean([end[0] ** 2 + end[1] ** 2 for end in ends]))
    bound = np.sqrt(np.mean([walk.bound[0] ** 2 for walk in walks]))
    # 80 normal numbers: their root mean square is known to 8 %; the filter also has to
    # learn A, which is 0 here
    assert 0.84 * bound < rms < 1.4 * bound


def test_what_is_claimed_is_said_before_the_last_reading():
    walk = followed(1)
    assert walk.claimed[0] == pytest.approx(np.hypot(*walk.stops[-1].doubt[:2]))
    assert walk.claimed[0] > np.hypot(*walk.stops[-1].claimed[:2])


def test_only_a_walk_that_learns_leaves_what_it_learnt():
    walk = followed(1)
    assert walk.learnt.bias == pytest.approx(MISSED, abs=1e-3)
    assert Followed(walk.stops, walk.feedback, learns=False).learnt is None
