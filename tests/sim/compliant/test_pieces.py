"""Pieces of the compliant prediction: commands, moments, windows, and what composes."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim.compliant.march import Commands, Track, _eventful, _row, _track, changes
from sim.compliant.phases import (
    Course,
    Motion,
    _composed,
    _during,
    _pieces,
    _remembered,
    _window,
)
from sim.motion.poses import compose

LOOKED_AT = 4  # moments of a phase at which commands are compared

DT = 0.01


ROWS = np.arange(1.0, 11.0).reshape(10, 1, 1)  # row k is k + 1


def commands(held=False, rows=ROWS):
    return Commands(rows, DT, np.array([1.0]), held)


@pytest.mark.parametrize(
    ("time", "value"),
    [
        (0.0, 1.0),  # before the end of the first step there is only its row
        (0.005, 1.0),
        (0.01, 1.0),  # smooth commands come to row 0 at the end of step 0
        (0.015, 1.5),
        (0.0375, 3.75),
        (0.1, 10.0),
        (7.0, 10.0),
        (-1.0, 1.0),
    ],
)
def test_smooth_commands_come_to_a_row_at_the_end_of_its_step(time, value):
    found = commands().at(np.array([time]))
    assert found.shape == (1, 1, 1)
    assert found[0, 0, 0] == pytest.approx(value)


def test_an_increment_of_smooth_commands_has_a_begin_and_an_end():
    begin, end = commands().over(np.array([0.02, 0.05]), np.array([0.03, 0.08]))
    assert begin[:, 0, 0] == pytest.approx([2.0, 5.0])
    assert end[:, 0, 0] == pytest.approx([3.0, 8.0])


@pytest.mark.parametrize(
    ("time", "value"),
    [(0.0, 1.0), (0.0099, 1.0), (0.01 - 1e-12, 2.0), (0.01, 2.0), (0.2, 10.0)],
)
def test_held_commands_keep_a_row_through_its_step(time, value):
    begin, end = commands(held=True).over(np.array([time]), np.array([time + DT]))
    assert begin[0, 0, 0] == end[0, 0, 0] == value


def test_held_commands_change_where_a_row_is_another():
    rows = np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 2.0], [1.0, 2.0], [0.0, 2.0]])
    assert changes(rows, 0.5) == pytest.approx([1.0, 2.0])


def forced(*loads):
    """Forces on two points of one foot in several lanes, straight up."""
    force = np.zeros((len(loads), 1, 2, 3))
    force[:, 0, :, 2] = loads
    return SimpleNamespace(force=force)


def test_events_are_touches_partings_and_large_changes_of_load():
    before = forced((1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, 1.0), (0.0, 0.0))
    after = forced((1.0, 0.0), (1.0, 0.1), (1.0, 0.0), (1.5, 1.0), (0.0, 0.0))
    found = _eventful(before, after, np.array([0.4, 0.4, 0.4, 0.4, 0.4]))
    assert found.tolist() == [False, True, True, True, False]
    found = _eventful(before, after, np.full(5, 0.6))
    assert found.tolist() == [False, True, True, False, False]


def test_a_foot_touches_where_its_loads_are_in_the_mean():
    state = forced((3.0, 1.0), (0.0, 0.0), (-1.0, 2.0))
    state.place, state.turned = np.zeros((3, 3)), np.zeros((3, 3, 3))
    arm = np.zeros((3, 1, 2, 3))
    arm[:, 0, 0, :2], arm[:, 0, 1, :2] = (1.0, 0.0), (0.0, 2.0)
    rest = dict.fromkeys(("slip", "torque", "center"), np.zeros((3, 1)))
    done = SimpleNamespace(state=state, arm=arm, **rest)
    *_, whole, _, _, point = _row(np.arange(3), np.zeros(3), done, np.ones(3, bool))
    assert whole[:, 0] == pytest.approx([4.0, 0.0, 2.0])
    assert point[:, 0] == pytest.approx(np.array([[0.75, 0.5], [0.5, 1.0], [0.0, 2.0]]))


def test_rows_of_a_track_are_sorted_by_lane_in_their_order():
    names = list(Track.__dataclass_fields__)
    one = [np.array([2, 0]), np.array([0.0, 0.1])]
    two = [np.array([0, 1, 2]), np.array([0.2, 0.3, 0.4])]
    fill = [[np.zeros(n)] * (len(names) - 2) for n in (2, 3)]
    track = _track([(*one, *fill[0]), (*two, *fill[1])])
    assert track.time[track.of(0)].tolist() == [0.1, 0.2]
    assert track.time[track.of(1)].tolist() == [0.3]
    assert track.time[track.of(2)].tolist() == [0.0, 0.4]


def moving(times):
    """A motion of two feet whose numbers are times of their own."""
    times = np.asarray(times, dtype=float)
    wide = times[:, None]
    pose = wide * [1.0, 0.0, 0.0]
    lean, slip, load = wide * [0.0, 1.0, 2.0], wide * [1.0, 3.0], wide * [2.0, 1.0]
    torque = wide[..., None] * np.ones((2, 3))
    return Motion(times, pose, lean, slip, load, torque, margin=5 * times)


@pytest.mark.parametrize("time", [-1.0, 0.0, 0.13, 0.2, 0.35, 0.4, 9.0])
def test_between_moments_motion_is_on_a_line_and_beyond_them_it_stays(time):
    found = moving([0.0, 0.2, 0.4]).at(np.array([time]))
    kept = min(max(time, 0.0), 0.4)
    assert found.time == [time]
    for part, best in zip(found[1:], moving([kept])[1:], strict=True):
        assert part == pytest.approx(best)


def test_of_two_moments_at_a_time_the_first_is_taken():
    motion = moving([0.0, 0.2, 0.2, 0.4])
    motion.margin[:] = [0.0, 1.0, 3.0, 5.0]
    found = motion.at(np.array([0.1, 0.2, 0.3])).margin
    assert found == pytest.approx([0.5, 1.0, 4.0])


def walk_of(spans, memory=0.5, rows=None):
    """A course with phases between steps of 0.1 s."""
    count = int(np.max(spans))
    rows = np.arange(float(count)).reshape(-1, 1, 1) if rows is None else rows
    heading = np.arange(len(spans), dtype=float)
    made = Commands(rows, 0.1, np.array([count * 0.1]))
    return Course(made, np.array(spans), heading, {0: np.zeros(3)}, memory)


SPANS = [(0, 3), (3, 6), (6, 8), (8, 14), (14, 20)]


@pytest.mark.parametrize(("phase", "first"), [(0, 0), (1, 0), (2, 0), (3, 1), (4, 3)])
def test_feet_remember_the_phase_that_lasted_a_memory_before(phase, first):
    """Of 5 steps: as phase 3 begins with step 8, step 3 is the first one remembered."""
    assert _remembered(walk_of(SPANS), phase) == first


def test_a_window_has_the_steps_of_phases_and_commands_at_moments_of_each():
    shape, like = _window(walk_of(SPANS), 3)
    assert shape == (-5, -2, -2, 0, 0, 6)
    assert like.heading == 3.0
    looks = like.looks[:, 0, 0]
    assert looks[0] == 3.0  # the row with which what is remembered begins
    assert looks[-1] == 13.0  # the last one of the phase
    assert len(looks) == 1 + 3 * LOOKED_AT
    ends = looks[LOOKED_AT::LOOKED_AT]
    assert ends.tolist() == [5.0, 7.0, 13.0]
    assert (np.diff(looks) >= 0).all()
    quarters = looks[-LOOKED_AT:]
    assert quarters.tolist() == [np.ceil(8 + 6 * k / 4) - 1 for k in (1, 2, 3, 4)]


@pytest.mark.parametrize("robots", [1, 4])
def test_new_phases_are_cut_into_pieces_that_follow_one_another(robots):
    new = [0, 1, 2, 3, 7, 8, 9]
    pieces = list(_pieces(new, np.full(10, 3.0), robots))
    assert [phase for piece in pieces for phase in piece] == new
    assert all(np.diff(piece).max(initial=1) == 1 for piece in pieces)


def test_few_phases_are_one_piece_and_many_lanes_are_worth_longer_ones():
    """Work is that of an increment, which grows with lanes, times what is walked."""
    lasting = np.full(100, 2.0)
    alone = list(_pieces(range(100), lasting, 1))
    several = list(_pieces(range(100), lasting, 16))
    assert list(_pieces([4], lasting, 1)) == [[4]]
    assert list(_pieces([3, 4], np.full(5, 0.2), 1)) == [[3, 4]]
    assert 1 < len(several) < len(alone)
    # with n pieces of all 200 memories, (200 / n + 1) (40 + robots n) is least
    for robots, pieces in ((1, alone), (16, several)):
        tried = {n: (200 / n + 1) * (40 + robots * n) for n in range(1, 101)}
        assert len(pieces) == pytest.approx(min(tried, key=tried.get), rel=0.45)
    sizes = [len(piece) for piece in alone]
    assert max(sizes) - min(sizes) <= 1


def test_a_phase_of_a_lane_begins_at_rest_with_no_slip():
    times = np.array([0.0, 0.1, 0.2, 0.3, 0.4])
    yaw = np.array([0.0, 3.0, 3.1, -3.1, -3.0])
    motion = moving(times)._replace(
        pose=np.column_stack([times, 0 * times, yaw]), slip=np.full((5, 2), 0.5)
    )
    found = _during(motion, np.array([0.1, 0.3]))
    assert found.time == pytest.approx([0.0, 0.1, 0.2])
    assert found.slip[:, 0] == pytest.approx([0.0, 0.5, 1.0])
    assert found.pose[0] == pytest.approx([0.0, 0.0, 0.0])
    assert found.pose[-1, 2] == pytest.approx(2 * np.pi - 6.1)
    first = np.array([0.1, 0.0, 3.0])
    assert compose(first, found.pose[-1])[:2] == pytest.approx([0.3, 0.0])


def test_a_walk_is_composed_of_its_phases_and_begins_anew_where_it_is_put():
    piece = moving([0.0, 0.3])._replace(
        pose=np.array([[0.0, 0, 0], [1.0, 0.0, np.pi / 2]]),
        slip=np.array([[0.0, 0], [1, 2]]),
    )
    course = walk_of([(0, 3), (3, 6), (6, 9)])
    motion, headings = _composed(course, [piece] * 3)
    assert headings == pytest.approx([0.0, np.pi / 2, np.pi])
    assert motion.time == pytest.approx([0.0, 0.3, 0.3, 0.6, 0.6, 0.9])
    assert motion.pose[-1, :2] == pytest.approx([0.0, 1.0])
    assert motion.slip[-1] == pytest.approx([3.0, 6.0])
    again = Course(
        course.commands, course.spans, course.heading, {2: np.array([5.0, 5, 0])}
    )
    moved, _ = _composed(again, [piece] * 3)
    assert moved.pose[-1] == pytest.approx([6.0, 5.0, np.pi / 2])
    assert moved.slip[-1] == pytest.approx([3.0, 6.0])
