"""Where logs begin to be refused, bridged or remarked upon: both sides of borders."""

from math import pi, radians

import numpy as np
import pytest

from sim.errors import UsageError
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
        ("body.roll", 4 * pi * 0.999, False),
        ("body.pitch", -4 * pi * 1.001, True),
        ("body.yaw", 9 * pi, False),  # it winds up
        ("body.yaw.error", 999.0, False),
        ("contact.1", 2.0, True),
        ("body.x.error", 1e6, False),
        ("body.x.error", 1.001e6, True),
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


@pytest.mark.parametrize(
    ("column", "lacks"),
    [
        ("measured.lift_1", "lift_1"),
        ("body.x.error", "body.x"),
        ("measured.hip_1", None),
        ("body.yaw", None),
    ],
)
def test_what_was_measured_of_nothing_is_left_out_with_a_word(read, column, lacks):
    said = [f"{column} is left out; there is no {lacks}"] if lacks else []
    assert [*read(f"time,hip_1,{column}\n0,0,0\n1,0,0\n").done] == said


def test_joints_may_be_called_as_errors_are(tmp_path):
    (tmp_path / "log.csv").write_text("time,a.error,measured.a.error\n0,0,0\n1,0,0\n")
    assert read_log(tmp_path / "log.csv", ("a.error",), ()).done == ()


def test_empty_cells_are_bridged_evenly_and_held_beyond_the_ends(read):
    said = "hip_1: empty cells bridged, or held at an end, {}; {} s at most"
    cells = ["", "1", "", "", "2", "3", ""]
    rows = [f"{0.1 * k:.1f},{cell}" for k, cell in enumerate(cells)]
    log = read("time,hip_1\n" + "\n".join(rows) + "\n")
    assert log.commanded[:, 0] == pytest.approx([1, 1, 4 / 3, 5 / 3, 2, 3, 3])
    assert log.done == (said.format(4, 0.3),)
    ends = read("time,hip_1\n0,\n0.1,1\n0.2,2\n")
    assert ends.done == (said.format(1, 0.1),)


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
        (lambda: Log(np.array([5.0, 6.0]), (), np.zeros((2, 0))), "ascend from 0"),
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
        return {"hip_1": time / 100}

    if not fine:
        with pytest.raises(ValueError, match="rows a second; give a duration"):
            of_function(gait, duration, rate)
        return
    log = of_function(gait, duration, rate)
    assert len(log.time) == round(duration * rate) + 1
    assert log.duration == pytest.approx(duration)
    assert log.commanded[:, 0] == pytest.approx(log.time / 100)


def test_a_gait_has_200_rows_a_second_where_none_are_asked_for():
    assert len(of_function(lambda t: {"hip_1": t}, 0.1).time) == 21


def test_names_with_a_point_are_columns_and_others_are_joints():
    require_joints(["hip_1"], ["hip_1", "lift_1"])
    with pytest.raises(ValueError, match="the robot has no joint 'hip_2'"):
        require_joints(["hip_1", "hip_2"], ["hip_1"])
    with pytest.raises(ValueError, match=r"there is no column 'body\.z'"):
        require_joints(["body.z"], ["hip_1"])


def test_a_missing_log_and_one_in_utf_16_are_what_was_given_wrongly(tmp_path):
    path = tmp_path / "log.csv"
    with pytest.raises(
        UsageError, match="^no such log, No such file .*log.csv; give a"
    ):
        read_log(path, ("hip_1",), (1,))
    path.write_text("time,hip_1\n0,0\n1,0.1\n", encoding="utf-16")
    with pytest.raises(UsageError, match="zero bytes, as UTF-16 does: .*; save it in"):
        read_log(path, ("hip_1",), (1,))


def test_blanks_around_names_do_not_count_unless_they_are_part_of_a_joint_s(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time , hip_1, lead,lead\n0,0,1,2\n1,0,1,2\n")
    log = read_log(path, ("hip_1", " lead", "lead"), (1,))
    assert log.joints == ("hip_1", " lead", "lead")
    assert log.commanded.tolist() == [[0, 1, 2]] * 2
