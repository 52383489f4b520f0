"""Poses that a robot elsewhere sends: which lines are poses, and which count."""

import io
import json
import time
from types import SimpleNamespace

import numpy as np
import pytest

from sim.commands import drive as command
from sim.commands.drive import Link, Poses
from sim.errors import UsageError


def read(text):
    poses, found = Poses(io.StringIO(text)), []
    while not poses.ended:
        if (pose := poses.next(1.0)) is not None:
            found.append(pose)
    return found


def test_poses_are_lines_and_what_they_do_not_tell_is_not_a_number():
    lines = '{"time": 1, "x": 0.1, "y": 0, "yaw": 3}\n\n{"time": 2, "x": null}\n'
    (first, pose), (second, unseen) = read(lines)
    assert (first, pose, second) == (1.0, [0.1, 0.0, 3.0], 2.0)
    assert np.isnan(unseen).all()


@pytest.mark.parametrize(
    "line",
    [
        "x",
        "[1]",
        '{"x": 1}',
        '{"time": "now"}',
        '{"time": NaN}',
        '{"time": 1, "x": 1e9}',
        '{"time": "9_9"}',
        '{"time": 1, "x": true}',
        '{"time": 1, "yaw": "\u0661"}',
        '{"time": 1, "X": 0.1}',
        '{"time": 1, "x": 0.1, "x": 0.2}',
        "[" * 100_000,
    ],
)
def test_a_line_that_is_no_pose_is_refused_with_its_number(line):
    with pytest.raises(UsageError, match="not a pose, .*: line 2 of --poses; write"):
        read('{"time": 1}\n' + line + "\n")


def test_it_is_told_once_that_the_poses_have_ended(capsys):
    poses = Poses(io.StringIO('{"time": 1}\n'))
    assert poses.next(1.0)[0] == 1.0
    assert not capsys.readouterr().err
    assert [poses.next(1.0), poses.next(1.0)] == [None, None]
    assert capsys.readouterr().err.count("the poses have ended") == 1


def mean_of(*poses, readings):
    """What a stop reads of poses that have come, and how many lines are left."""
    text = "".join(json.dumps({"time": 1.0, **pose}) + "\n" for pose in poses)
    lines = Poses(io.StringIO(text))
    link = Link(lines, io.StringIO(), pace=0, patience=0.0)
    sensing = SimpleNamespace(readings=readings, every=1, until=None)
    walk = SimpleNamespace(
        feedback=SimpleNamespace(sensing=sensing),
        time=1.0,
        stops=[],
        joints=("swing_1",),
        wait=lambda: (0.0, np.zeros(1)),
    )
    found = link.reading(walk)
    return found, sum(1 for _ in iter(lambda: lines.next(1.0), None))


def test_readings_of_a_robot_that_faces_backward_are_averaged_across_the_half_turn():
    backward = [{"x": 1.0, "y": 0.0, "yaw": yaw} for yaw in (3.13, -3.13, 3.14)]
    (x, _, yaw), _ = mean_of(*backward, readings=3)
    assert x == 1
    assert yaw == pytest.approx((3.13 + 3.14 + 2 * np.pi - 3.13) / 3, abs=1e-12)


def test_a_lost_frame_is_left_out_of_the_mean_of_a_stop():
    seen, lost = {"x": 0.02, "y": 0.5, "yaw": 0.1}, {}
    assert mean_of(seen, lost, readings=2) == ([0.02, 0.5, 0.1], 0)
    np.testing.assert_array_equal(mean_of(lost, lost, readings=2)[0], [np.nan] * 3)
    assert mean_of(seen, {"yaw": 0.3}, readings=2)[0] == [0.02, 0.5, 0.2]


def test_poses_beyond_the_readings_of_a_stop_are_left_for_the_next():
    first, second = ({"x": x, "y": 0.0, "yaw": 0.0} for x in (0.02, 0.04))
    assert mean_of(first, second, readings=1) == ([0.02, 0.0, 0.0], 1)


@pytest.mark.parametrize("when", [1.7e9, 3500.0, 6.5])
def test_poses_of_another_clock_are_refused(when):
    """Of epoch, in milliseconds, three seconds ahead: all that came would count."""
    came = iter([(3.4, [0.0, 0.0, 0.0]), (when, [0.0, 0.0, 0.0])])
    poses = SimpleNamespace(next=lambda _: next(came))
    link = SimpleNamespace(poses=poses, pace=1.0, seen=[])
    since = command.Link._since(link, 3.0, 3.5)
    assert next(since) == [0.0, 0.0, 0.0]
    with pytest.raises(UsageError, match=r"a pose of .* s came when .* of 3.5 s"):
        next(since)


def test_a_pose_that_is_sent_thrice_is_one_reading():
    sent = {"x": 0.0, "y": 0.0, "yaw": 0.0}
    other = {"x": 0.03, "y": 0.0, "yaw": 0.0}
    assert mean_of(sent, sent, sent, other, readings=2) == ([0.015, 0.0, 0.0], 0)
    third = {"x": 0.06, "y": 0.0, "yaw": 0.0}
    mean = pytest.approx([0.03, 0.0, 0.0])
    assert mean_of(sent, other, sent, other, third, readings=3) == (mean, 0)


@pytest.mark.parametrize(
    "line", [b'{"time": 1' + 400 * b"0" + b"}", b"\xff\xfe", b"[" * 20_000]
)
def test_whatever_is_sent_for_a_pose_is_refused_in_one_line(line):
    """Neither an overflow nor bytes that are no text end the thread that listens."""
    poses = Poses(io.TextIOWrapper(io.BytesIO(line + b"\n"), encoding="utf-8"))
    said = "not a pose, (broken|no time, or a number).*: line 1"
    with pytest.raises(UsageError, match=said):
        poses.next(10.0)


def test_poses_that_nobody_asks_for_take_no_more_memory(monkeypatch):
    monkeypatch.setattr("sim.commands.drive.MOST_WAITING", 3)
    lines = "".join(f'{{"time": {second}}}\n' for second in range(9))
    poses = Poses(io.StringIO(lines))
    time.sleep(0.2)
    assert [poses.next(10.0)[0] for _ in range(3)] == [6.0, 7.0, 8.0]
    assert poses.next(10.0) is None


@pytest.mark.parametrize(("pace", "waits"), [(True, 1e-3), (False, 0.02)])
def test_poses_since_a_moment_are_read_without_waiting_where_the_walk_has_a_pace(
    pace, waits
):
    """Those of the moment itself are not older."""
    came, asked = iter([(0.9, "a"), (1.0, "b"), (1.2, "c"), None]), []

    def next_pose(seconds):
        asked.append(seconds)
        return next(came)

    poses = SimpleNamespace(next=next_pose)
    link = SimpleNamespace(poses=poses, pace=pace, seen=[])
    assert [*command.Link._since(link, 1.0, 1.2)] == ["b", "c"]
    assert asked == [waits] * 4


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('{"time": "2026-01-01T12:00:00", "x": 0.0}', "not a number"),
        ('{"time": {"sec": 1}}', "not a number"),
        ('{"time": 1, "x": 0.1, "x": 0.2}', "a key twice"),
    ],
)
def test_it_is_said_what_is_wrong_with_a_pose(line, said):
    with pytest.raises(UsageError, match=f"not a pose, {said}: line 1"):
        read(line + "\n")
