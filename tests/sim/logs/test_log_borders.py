"""Where logs begin to be refused, bridged or remarked upon: both sides of borders."""

from dataclasses import replace
from math import degrees, pi, radians

import numpy as np
import pytest

from sim.errors import UsageError
from sim.logs.alignment import measured, together
from sim.logs.log import Log, of_function, read_log, require_joints

JOINTS, LEGS = ("hip_1", "lift_1"), (1, 2)


@pytest.fixture
def read(tmp_path):
    def reading(text, angles=""):
        path = tmp_path / "log.csv"
        path.write_text(text)
        return read_log(path, JOINTS, LEGS, angles)

    return reading


def table(times, column="hip_1", values=None):
    values = [0.0] * len(times) if values is None else values
    asked = "" if column == "hip_1" else ",0"
    rows = [f"{t!r}{asked},{v!r}" for t, v in zip(times, values, strict=True)]
    names = f"time,{column}" if column == "hip_1" else f"time,hip_1,{column}"
    return "\n".join([names, *rows]) + "\n"


@pytest.mark.parametrize(
    ("times", "said"),
    [
        ([0.0, 0.01], ""),
        ([0.0, 0.0099], "it lasts 0.0099 s"),
        ([5.0, 605.0], ""),
        ([5.0, 605.1], "it lasts 600.1 s"),
        ([0.0, 1.001e-6, 1.0], ""),
        ([0.0, 1.0, 1.0 + 0.9e-6], "from 1 s to 1.0000009 s in row 3"),
        ([0.0, 0.5, 0.4, 1.0], "from 0.5 s to 0.4 s in row 3"),
    ],
)
def test_times_ascend_and_last_from_a_hundredth_of_a_second_to_ten_minutes(
    read, times, said
):
    if not said:
        assert read(table(times)).duration == pytest.approx(times[-1] - times[0])
        return
    with pytest.raises(UsageError) as caught:
        read(table(times))
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("column", "value", "refused"),
    [
        ("hip_1", 4 * pi * 0.999, False),
        ("hip_1", -4 * pi * 1.001, True),
        ("measured.hip_1", -4 * pi * 0.999, False),
        ("measured.hip_1", 4 * pi * 1.001, True),
        ("body.roll", 4 * pi * 1.001, False),  # no joint
        ("body.roll", 1e6, False),
        ("body.roll", -1.001e6, True),
        ("contact.2", 1.0, False),
        ("contact.2", 0.5, True),
        ("contact.2", -1.0, True),
    ],
)
def test_angles_go_twice_around_and_other_numbers_to_a_million(
    read, column, value, refused
):
    text = table([0.0, 0.5, 1.0], column, [0.0, value, 0.0])
    if refused:
        with pytest.raises(
            UsageError, match=r"row 2, at 0\.5 s|beyond 1e\+06|other than"
        ):
            read(text)
    else:
        read(text)


@pytest.mark.parametrize("late", [0.0, 0.2])
def test_a_log_that_begins_later_is_counted_from_there(read, late):
    log = read(table([late, late + 0.1, late + 0.2]))
    assert log.time == pytest.approx([0.0, 0.1, 0.2])
    said = [f"time begins at {late:g} s and is counted from there"] if late else []
    assert [*log.done] == said


@pytest.mark.parametrize("factor", [2.4, 2.6])
def test_two_and_a_half_steps_of_the_clock_are_a_gap(read, factor):
    steps = np.full(20, 0.1)
    steps[7] = steps[12] = 0.1 * factor
    done = read(table(np.append(0.0, np.cumsum(steps)).tolist())).done
    gaps = [line for line in done if line.startswith("gaps")]
    assert len(gaps) == (factor > 2.5)
    if gaps:
        assert f"up to {0.1 * factor:.3g} s between rows, 2 in all" in gaps[0]


@pytest.mark.parametrize("jitter", [0.045, 0.055])
def test_steps_that_vary_by_a_twentieth_are_mentioned(read, jitter):
    steps = 0.1 * (1 + jitter * (-1.0) ** np.arange(40))
    steps = np.append(steps, 0.1)
    done = read(table(np.append(0.0, np.cumsum(steps)).tolist())).done
    said = [line for line in done if "vary" in line]
    assert len(said) == (jitter > 0.05)
    if said:
        assert f"by {1e3 * steps.std():.2g} ms around 100 ms" in said[0]


def test_empty_cells_are_bridged_evenly_and_held_beyond_the_ends(read):
    cells = ["", "1", "", "", "2", "3", ""]
    rows = [f"{0.1 * k:.1f},{cell}" for k, cell in enumerate(cells)]
    log = read("time,hip_1\n" + "\n".join(rows) + "\n")
    assert log.commanded[:, 0] == pytest.approx([1, 1, 4 / 3, 5 / 3, 2, 3, 3])
    assert log.done == ("hip_1: empty cells bridged, 4; 0.3 s at most",)
    ends = read("time,hip_1\n0,\n0.1,1\n0.2,2\n")
    assert ends.done == ("hip_1: empty cells bridged, 1; 0 s at most",)


def plain(rows=3, **parts):
    time = np.arange(rows, dtype=float)
    return Log(time, ("hip_1",), parts.pop("commanded", np.zeros((rows, 1))), **parts)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: plain(1), "fewer than two rows; give two at least"),
        (
            lambda: plain(2, commanded=np.zeros((2, 2))),
            r"commands \(2, 2\) for \(2, 1\)",
        ),
        (
            lambda: plain(3, commanded=np.zeros((2, 1))),
            r"commands \(2, 1\) for \(3, 1\)",
        ),
        (lambda: plain(2, commanded=np.full((2, 1), np.nan)), "not a finite number"),
        (lambda: Log(np.array([0.0, 0.0]), (), np.zeros((2, 0))), "does not ascend"),
        (lambda: Log(np.array([0.0, 1.0, 0.5]), (), np.zeros((3, 0))), "not ascend"),
    ],
)
def test_arrays_that_contradict_one_another_are_no_log(make, said):
    with pytest.raises(ValueError, match=said):
        make()
    assert plain(2).duration == 1.0


@pytest.mark.parametrize("apart", [0.99, 1.01])
def test_a_motion_is_repeated_if_it_ends_within_a_degree_of_its_start(apart):
    rows = np.array([[0.0], [0.3], [-radians(apart)]])
    log = plain(3, commanded=rows, measured=rows, done=("said",))
    assert log.repeated(1).commanded.tolist() == rows.tolist()
    if apart > 1:
        with pytest.raises(ValueError, match="cannot be repeated; let it end where it"):
            log.repeated(2)
        return
    again = log.repeated(3)
    assert again.time.tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert again.commanded[:, 0] == pytest.approx([0, 0.3, 0, 0.3, 0, 0.3, rows[-1, 0]])
    assert again.measured is None
    assert again.done == ("said", "repeated 3 times")


@pytest.mark.parametrize(
    ("duration", "rate", "fine"),
    [
        (600.0, 1.0, True),
        (600.1, 1.0, False),
        (0.0, 100.0, False),
        (-1.0, 100.0, False),
        (2.0, 1.0, True),
        (2.0, 0.99, False),
        (0.01, 1e4, True),
        (0.01, 1.001e4, False),
    ],
)
def test_a_gait_lasts_up_to_ten_minutes_at_1_to_10_000_rows_a_second(
    duration, rate, fine
):
    def gait(time):
        return {"hip_1": time}

    if not fine:
        with pytest.raises(ValueError, match="rows a second; give a duration"):
            of_function(gait, duration, rate)
        return
    log = of_function(gait, duration, rate)
    assert len(log.time) == round(duration * rate) + 1
    assert log.duration == pytest.approx(duration)
    assert log.commanded[:, 0] == pytest.approx(log.time)


def test_a_gait_has_200_rows_a_second_where_none_are_asked_for():
    assert len(of_function(lambda t: {"hip_1": t}, 0.1).time) == 21


def test_names_with_a_point_are_columns_and_others_are_joints():
    require_joints(["hip_1"], ["hip_1", "lift_1"])
    with pytest.raises(ValueError, match="the robot has no joint 'hip_2'"):
        require_joints(["hip_1", "hip_2"], ["hip_1"])
    with pytest.raises(ValueError, match=r"there is no column 'body\.z'"):
        require_joints(["body.z"], ["hip_1"])


TIME = np.linspace(0, 2, 41)
WAY = np.stack([0.1 * TIME, 0 * TIME, 0 * TIME], axis=1)


def posed(pose, **parts):
    return Log(TIME, ("hip",), np.zeros((41, 1)), pose=pose, **parts)


@pytest.mark.parametrize("angle", [4.9, -4.9, 5.1, -5.1])
def test_a_frame_that_is_turned_by_five_degrees_is_turned_back(angle):
    a = radians(angle)
    turned = np.stack(
        [0.1 * TIME * np.cos(a), 0.1 * TIME * np.sin(a), 0 * TIME], axis=1
    )
    seen = measured(posed(turned), TIME, WAY)
    if abs(angle) > 5:
        np.testing.assert_allclose(seen.pose, WAY, atol=1e-12)
        assert f"is turned by {angle:.1f} degrees against the robot" in seen.done[0]
    else:
        np.testing.assert_allclose(seen.pose, turned, atol=1e-12)
        assert seen.done == ()


@pytest.mark.parametrize("way", [0.009, 0.011])
def test_of_a_motion_of_less_than_a_centimetre_no_direction_is_known(way):
    part = TIME / 2
    ahead, left = way * np.stack([part, 0 * part]), way * np.stack([0 * part, part])
    poses = [np.column_stack([*xy, 0 * TIME]) for xy in (ahead, left)]
    seen = measured(posed(poses[1]), TIME, poses[0])
    best = poses[0] if way > 0.01 else poses[1]
    np.testing.assert_allclose(seen.pose, best, atol=1e-12)


@pytest.mark.parametrize(
    ("first", "said"),
    [
        ((0.007, 0.007, 0.0), False),
        ((0.008, 0.008, 0.0), True),
        ((0.0, 0.0, radians(4.9)), False),
        ((0.0, 0.0, -radians(5.1)), True),
        ((0.0, 0.0, 2 * pi - radians(1)), False),
    ],
)
def test_a_first_pose_away_from_the_origin_is_told(first, said):
    x, y, yaw = first
    cos, sin = np.cos(yaw), np.sin(yaw)
    seen = WAY @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]]) + first
    found = measured(posed(seen), TIME, WAY)
    np.testing.assert_allclose(found.pose, WAY, atol=1e-12)
    told = [line for line in found.done if "counted from the first" in line]
    assert len(told) == said
    if said:
        assert f"({x:.3g}, {y:.3g}) m and {degrees(yaw):.1f} degrees" in told[0]


@pytest.mark.parametrize("apart", [0.99, 1.01])
def test_commands_of_trials_may_differ_by_a_degree(apart):
    other = replace(posed(WAY), commanded=np.full((41, 1), -radians(apart)))
    done = together([posed(WAY), other]).done
    assert len(done) == 1 + (apart > 1)
    assert done[-1] == "mean of 2 trials, with its standard error"


def test_a_mean_needs_two_trials_with_a_pose():
    alone = together([posed(WAY), replace(posed(WAY), pose=None)])
    assert alone.done == ("fewer than two trials have a pose",)
    np.testing.assert_array_equal(alone.pose, WAY)
    assert together([posed(WAY)]).done == ()


def test_joints_of_trials_are_compared_by_their_names():
    two = np.stack([0.1 * TIME, -0.2 * TIME], axis=1)
    one = Log(TIME, ("a", "b"), two, pose=WAY)
    other = Log(TIME, ("b", "a"), two[:, ::-1], pose=WAY)
    assert len(together([one, other]).done) == 1


def test_yaw_of_trials_is_averaged_beyond_half_a_turn():
    turning = np.stack([0 * TIME, 0 * TIME, 2 * TIME], axis=1)
    wrapped = turning.copy()
    wrapped[:, 2] = (turning[:, 2] + pi) % (2 * pi) - pi
    mean = together([posed(turning), posed(wrapped)])
    np.testing.assert_allclose(mean.pose, turning, atol=1e-12)
    np.testing.assert_allclose(mean.spread, 0.0, atol=1e-12)


def test_an_angle_with_gaps_in_it_is_bridged_and_none_without_numbers_is_told():
    lean = np.stack([0.1 * TIME, np.full(41, np.nan)], axis=1)
    lean[3:6, 0] = np.nan
    found = measured(posed(None, lean=lean), TIME, WAY)
    assert [*found.lean] == ["roll"]
    np.testing.assert_allclose(found.lean["roll"], 0.1 * TIME, atol=1e-12)
    assert measured(posed(None, contact={1: np.ones(41)}), TIME, WAY).pose is None
    assert found.arrays.keys() == {"roll"}
    both = measured(posed(WAY, lean=0 * WAY[:, :2]), TIME, WAY)
    assert both.arrays.keys() == {"pose", "roll", "pitch"}
