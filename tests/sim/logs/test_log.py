"""Logs of anybody are read with care: what they say, and what they may not."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.errors import UsageError
from sim.logs.log import Log, of_function, read_log, written

JOINTS, LEGS = ("hip_1", "lift_1"), (1, 2)


@pytest.fixture
def read(tmp_path: Path):
    def reading(text: str, angles="") -> Log:
        path = tmp_path / "log.csv"
        path.write_text(text, encoding="latin-1")
        return read_log(path, JOINTS, LEGS, angles)

    return reading


def test_commands_and_what_was_measured_are_read_by_the_names_of_columns(read):
    log = read(
        "time,lift_1,hip_1,measured.hip_1,body.x,body.y,body.yaw,body.roll,contact.2\n"
        "0,0.1,0.2,0.19,1,2,3,0.01,1\n0.1,0.2,0.3,,1.5,2,3,0.02,0\n"
    )
    assert log.joints == ("lift_1", "hip_1")
    assert log.commanded.tolist() == [[0.1, 0.2], [0.2, 0.3]]
    np.testing.assert_array_equal(log.measured, [[np.nan, 0.19], [np.nan, np.nan]])
    assert log.pose.tolist() == [[1, 2, 3], [1.5, 2, 3]]
    np.testing.assert_array_equal(log.lean, [[0.01, np.nan], [0.02, np.nan]])
    assert {leg: c.tolist() for leg, c in log.contact.items()} == {2: [1, 0]}


def test_a_log_of_commands_alone_is_read_with_blank_lines_and_columns_around(read):
    log = read("\r\ntime;hip_1;;\n0;0;;\n1;1; ;\n")
    assert (log.measured, log.pose, log.lean, log.contact) == (None, None, None, {})


def test_marks_in_names_do_not_part_columns(tmp_path):
    path = tmp_path / "log.csv"
    for text, name in (
        ("time,hip;;1\n0,0\n1,1\n", "hip;;1"),
        ('time;"a,b,c"\n0;0\n1;1\n', "a,b,c"),
        ("hip;;1,time\r\n0,0\r\n1,1\r\n", "hip;;1"),
        ('"a,b";time\n0;0\n1;1\n', "a,b"),
        ('"time"\t"a,b,c;d"\n0\t0\n1\t1\n', "a,b,c;d"),
    ):
        path.write_text(text)
        assert read_log(path, (name,), LEGS).commanded.tolist() == [[0], [1]]


def test_degrees_hold_for_every_angle_and_a_function_for_joints_alone(read):
    names = "time,hip_1,measured.hip_1,body.yaw,body.yaw.error"
    text = f"{names}\n0,90,90,90,90\n1,0,0,0,0\n"
    log = read(text, "degrees")
    assert log.commanded[0] == log.measured[0] == log.pose[0, 2] == np.pi / 2
    assert log.spread[0, 2] == np.pi / 2
    text = f"{names}\n0,90,90,0.9,0.1\n1,0,0,0,0\n"
    log = read(text, {"hip_1": lambda counts: (counts - 90) / 100})
    assert (log.commanded[0], log.measured[0], log.pose[0, 2]) == (0, 0, 0.9)


def test_what_was_done_to_a_log_is_said(read):
    times = 5 + np.array([0, 0.01, 0.021, 0.03, 0.1, 0.11])
    rows = "".join(f"{t},{'' if k == 1 else k / 100}\n" for k, t in enumerate(times))
    log = read("time,hip_1\n" + rows)
    assert log.commanded[1, 0] == pytest.approx(0.02 * 0.01 / 0.021)
    assert log.time[0] == 0
    assert log.done == (
        "time begins at 5 s and is counted from there",
        "gaps of up to 0.07 s between rows, 1 in all; "
        "commands are interpolated across them",
        "times between rows vary by 0.71 ms around 10 ms; each row keeps its own time",
        "hip_1: empty cells bridged, or held at an end, 1; 0.021 s at most",
    )


def test_rows_a_microsecond_apart_are_read_however_they_are_rounded(read):
    times = [9.0 + k * 1e-6 for k in range(2)] + [9.5]
    assert np.diff(times)[0] < 1e-6
    log = read("time,hip_1\n" + "".join(f"{t:.6f},0\n" for t in times))
    assert len(log.time) == 3


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no column 'time': .*; begin with a line of names"),
        ("time,hip_1\n0,0\n", "fewer than two rows of numbers: .*; give two at"),
        (
            "time,hip_1\n0,0\n0,1\n",
            "time goes from 0 s to 0 s in row 2: .*; sort them, 1e-06 s apart at least",
        ),
        ("time,hip_1\n0,0\n,1\n", "no time in row 2"),
        ("time,hip_1\n0,0\n1e9,1\n", r"lasts 1e\+09 s: .*; give 0.01 to 600 s"),
        ("time,hip_1\n0,0\n1e-3,1\n", "lasts 0.001 s: .*; give 0.01 to 600 s"),
        ("time,hip_1\n0,0\n1e-9,1\n9,1\n", "from 0 s to 1e-09 s in row 2: .*; sort"),
        (
            "time,hip_1,body.x,body.y,body.x.error\n0,0,0,0,1e-3\n1,1,1,0,-1e-9\n",
            "a negative standard error in column 'body.x.error'",
        ),
        ("time,hip_1,body.x,body.y\n0,0,0,0\n1,1,1,1e308\n", "beyond 1e.06 in .*y'"),
        (
            "time,hip_1,body.x,body.y\n0,0,0,0\n1,1,-2e6,0\n",
            "beyond 1e.06 in .*'body.x'",
        ),
        ("time,hip_1,contact.1\n0,0,1\n1,1,7\n", "'contact.1' has .* other than 0"),
        ("0,0,0\n1,0,0\n", "no column 'time'"),
        ('time,hip_1\n0,0\n1,"0.0"5\n', "',' expected after '\"'"),
        ('time,hip_1\n0,0\n1,"0.0\n5"\n', "in row 2, column 'hip_1'"),
        ("\x80\x04\x95\xee", "no column 'time'"),
        (f"time{',a' * 10**6}\n0\n", "column 'a' comes twice"),
        (f"time{',' * 10**6}\n" + f"0{',0' * 10**6}\n" * 10, "more than 5000000 numb"),
        ("time,hip_1,,\n0,0,,1\n1,1,,\n", "the robot has no joint ''"),
        ("time,hip_1\n0,0\n1,inf\n", "'inf' in row 2, column 'hip_1'"),
        ("time,hip_1\n0,0\n1,1_0\n", "'1_0' in row 2, column 'hip_1'"),
        ("time,hip_1\n0,0\n1,__import__('os')\n", "in row 2, column 'hip_1'"),
        ("time,hip_1\n0,0\n1,0,0\n", "row 2 has 3 of 2 columns"),
        ("time,hip_1\n0,\n1,\n", "column 'hip_1' is empty"),
        ("time,hip_1\n0,45\n1,0\n", "'hip_1' comes to 45 rad in row 1.*--units"),
        (
            "time,hip_1,measured.hip_1\n0,0,\n1,0,-45\n",
            "'measured.hip_1' comes to -45 rad in row 2, at 1 s: .*; give the right",
        ),
        ("time,hpi_1\n0,0\n1,1\n", "no joint 'hpi_1': .*did you mean 'hip_1'"),
        ("time,body.z\n0,0\n1,1\n", "no column 'body.z'"),
        ("time,body.x\n0,0\n1,1\n", "no column of a joint: .*; give one of hip_1"),
        ("time,hip_1,hip_1\n0,0,0\n1,1,1\n", "column 'hip_1' comes twice"),
        ("time,hip_1,body.x\n0,0,0\n1,1,1\n", "only one of body.x and body.y"),
        ("time,hip_1,body.x,body.y\n0,0,0,\n1,1,1,\n", "only one of body.x and"),
    ],
)
def test_what_is_no_log_is_refused_in_one_line(read, text, words):
    with pytest.raises(UsageError, match=words):
        read(text)


def test_what_is_no_file_or_too_large_is_no_log(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "large.csv").touch()
    os.truncate(tmp_path / "large.csv", 10**8 + 1)
    reasons = {
        "": "Is a directory",
        "gone.csv": "No such file or directory",
        "pipe.csv": "not a file",
        "large.csv": "larger than 100 MB",
    }
    for name, why in reasons.items():
        said = f"no such log, {why}: {tmp_path / name}; give a log, or a part of one"
        with pytest.raises(UsageError, match=f"^{said}$"):
            read_log(tmp_path / name, JOINTS, LEGS)


def test_digits_of_other_scripts_are_no_numbers(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,hip_1\n0,0\n1,\u0661\n", encoding="utf-8")
    with pytest.raises(UsageError, match="in row 2, column 'hip_1'"):
        read_log(path, JOINTS, LEGS)


def test_a_log_of_more_numbers_than_are_read_in_time_is_refused(read, monkeypatch):
    monkeypatch.setattr("sim.logs.log.MOST_NUMBERS", 5)
    with pytest.raises(UsageError, match="more than 5 numbers: .*; give a part of it"):
        read("time,hip_1\n0,0\n1,1\n2,2\n")


@pytest.mark.parametrize(("bound", "most"), [("MOST_NUMBERS", 2), ("LONGEST_ROW", 9)])
def test_lines_are_counted_before_they_are_parted(read, monkeypatch, bound, most):
    """Of millions, or of millions of names in one, reading takes minutes."""
    read("time,hip_1\n0,0\n1,1\n")
    monkeypatch.setattr(f"sim.logs.log.{bound}", most)
    with pytest.raises(UsageError, match=r"more than \d+ lines, or one that is too"):
        read("\ntime,hip_1\n0,0\n1,1\n")


def test_a_long_row_is_refused_before_it_is_parted(read, monkeypatch):
    monkeypatch.setattr("sim.logs.log.LONGEST_ROW", 15)
    read("time,hip_1\n0,0\n1,1\n")
    with pytest.raises(UsageError, match="or one that is too long"):
        read("time,hip_1\n0,0\n1," + "1," * 9 + "\n")


def test_a_log_that_is_written_is_read_back_with_every_digit(read):
    log = of_function(lambda t: {"hip_1": 0.1 * t, "lift_1": t / 3}, 0.02, 100)
    seen = {"pose": log.time[:, None] * [1, 2, np.nan], "contact": {2: log.time * 0}}
    log = replace(log, measured=log.commanded / 3, lean=log.commanded / 7, **seen)
    again = read(written(log))
    for name in ("time", "commanded", "measured", "pose", "lean"):
        np.testing.assert_array_equal(getattr(again, name), getattr(log, name))
    assert again.contact[2].tolist() == [0, 0, 0]


def test_commands_go_evenly_between_rows_and_are_held_beyond(read):
    log = read("time,hip_1\n0,0\n1,1\n")
    assert log.at(np.array([-1, 0.25, 2])).ravel().tolist() == [0, 0.25, 1]


def test_a_period_is_repeated_where_it_ends_as_it_begins(read):
    log = read("time,hip_1\n0,0\n1,1\n2,0\n")
    twice = log.repeated(2)
    assert twice.time.tolist() == [0, 1, 2, 3, 4]
    assert twice.commanded.ravel().tolist() == [0, 1, 0, 1, 0]
    with pytest.raises(ValueError, match="1 rad from its start cannot be repeated"):
        read("time,hip_1\n0,0\n1,1\n").repeated(2)


def test_a_period_is_repeated_as_often_as_the_whole_is_read_again(read, monkeypatch):
    log = read("time,hip_1\n0,0\n1,1\n2,0\n")
    assert read(written(log.repeated(300))).duration == 600
    with pytest.raises(ValueError, match="give --repeat 300 at most"):
        log.repeated(99999999999)
    monkeypatch.setattr("sim.logs.log.MOST_NUMBERS", 30)
    assert read(written(log.repeated(5))).duration == 10
    with pytest.raises(ValueError, match="give --repeat 5 at most"):
        log.repeated(6)


@pytest.mark.parametrize(
    ("angle", "said"),
    [
        (30.0, "a command of 30 rad; give"),
        (-30.0, "of 30 rad"),
        (np.nan, "no.* finite"),
    ],
)
def test_functions_give_angles_that_hinges_turn_to(angle, said):
    with pytest.raises(ValueError, match=said):
        of_function(lambda t: {"lift_1": 0.1, "hip_1": angle}, 0.02, 100)
