"""Where the error at the end of a walk comes from."""

import numpy as np
import pytest

from planner.planning.paths import line
from sim.evaluation.deviations import contributions, deviation_from
from sim.motion.poses import compose, seen_from

COMPARED = 1500  # poses that are compared with the path, evenly taken from all


def walked(steps):
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    return np.array(poses)


@pytest.fixture
def steps():
    return np.random.default_rng(6).normal(size=(30, 3))


def test_contributions_add_up_to_the_error_exactly(steps):
    achieved = walked(steps + 0.1 * np.random.default_rng(7).normal(size=(30, 3)))
    predicted = walked(steps)
    total = contributions(achieved, predicted).sum(axis=0)
    assert total == pytest.approx(achieved[-1] - predicted[-1], abs=1e-12)


def test_contributions_of_walks_that_differ_at_their_start_add_up_too(steps):
    achieved = walked(steps) + [0.1, 0.2, 0.3]
    parts = contributions(achieved, walked(steps))
    assert parts.sum(axis=0) == pytest.approx([0.1, 0.2, 0.3], abs=1e-12)


def test_a_walk_that_turns_past_a_half_turn_contributes_no_whole_turns():
    """Yaw is wrapped at different phases of the two, which are 0.2 rad apart."""
    ahead = np.tile([0.1, 0.0, 0.5], (10, 1))
    turned = ahead + [[0.0, 0.0, 0.2], *np.zeros((9, 3))]
    wrapped = [seen_from(np.zeros(3), walked(way)) for way in (turned, ahead)]
    assert np.ptp(wrapped[0][:, 2] - wrapped[1][:, 2]) > 6
    assert contributions(*wrapped)[:, 2] == pytest.approx([0.2, *[0.0] * 9], abs=1e-12)


def test_a_phase_that_moves_as_predicted_contributes_nothing(steps):
    wrong = steps.copy()
    wrong[11] += (0.2, -0.1, 0.3)
    parts = contributions(walked(wrong), walked(steps))
    others = np.delete(parts, 11, axis=0)
    assert others == pytest.approx(np.zeros((29, 3)), abs=1e-12)
    assert np.abs(parts[11]).max() > 0.1


def test_a_turn_too_far_is_charged_with_what_it_does_to_the_way_after_it():
    ahead = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    turned = ahead + [[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]
    parts = contributions(walked(turned), walked(ahead))
    assert parts[0] == pytest.approx([np.cos(0.1) - 1, np.sin(0.1), 0.1])
    assert parts[1] == pytest.approx(np.zeros(3), abs=1e-15)


@pytest.mark.parametrize("count", [500, 5 * COMPARED])
def test_the_farthest_from_the_path_is_found_among_any_number_of_poses(count):
    poses = np.linspace([0.0, 0.1, 0.2], [1.0, 0.1, 0.0], count)
    found = deviation_from(line((0, 0, 0), (1, 0, 0)), poses)
    assert (found.position, found.yaw) == pytest.approx((0.1, 0.2), abs=1e-3)
