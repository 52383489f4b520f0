"""Borders that numbers reach exactly: the last one taken, and the first beyond."""

import errno
import json
import os
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest

from sim import folder
from sim.commands.drive import _pose
from sim.errors import FilesError, UsageError, one_line
from sim.export.source import read_trajectory
from sim.fitting.fitting import check_measured, check_told
from sim.logs import log as logs
from sim.palette import TEXT, WHITE, Colour
from sim.physics.measure import CONTACT_FIELDS, _slots
from sim.preparation import scheduling
from sim.progress import Pace
from sim.runs import arrays
from sim.scenarios import body_path, obstacles
from sim.studies import designing
from sim.sweeps.ledger import _is_plain, _shown
from sim.sweeps.table import _column

LONGEST_MESSAGE = 1000  # characters of a line; what is left out is in its middle
FEWEST_ROWS = 20  # of a log; six parameters are fitted to each joint
TELLING = 0.05  # part of a stage from which on its end can be estimated
INT64 = 2**63  # beyond the numbers that a table takes


def test_a_line_of_the_longest_message_is_whole_and_a_longer_one_lacks_its_middle():
    def said(length):
        tail = ": here; go"
        return one_line(UsageError("x" * (length - len(tail)), "here", "go"))

    assert said(LONGEST_MESSAGE) == "x" * (LONGEST_MESSAGE - 10) + ": here; go"
    assert " ... " in said(LONGEST_MESSAGE + 1)


def test_settings_that_differ_are_shown_whole_up_to_eighty_characters():
    for length in (80, 81):
        text = "y" * (length - 2)
        assert (_shown({"a": text}, "a") == json.dumps(text)) == (length == 80)


def test_a_table_takes_numbers_of_64_bits_and_columns_of_whole_and_other_numbers():
    assert [_is_plain(n) for n in (INT64 - 1, 1 - INT64, INT64, -INT64)] == [
        True, True, False, False,
    ]  # fmt: skip
    assert _column([1, 2.5, None]).type == pa.float64()
    assert _column([1, 2]).type == pa.int64()


@pytest.mark.parametrize(("size", "said"), [(99_999, "100.0 kB"), (100_000, "0.1 MB")])
def test_a_full_disk_is_told_what_it_lacks_in_handy_units(size, said, tmp_path):
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    writing = folder._writing(tmp_path / "a", lambda: size)
    with pytest.raises(FilesError, match=f"disk full, {said} needed"), writing:
        raise full


@pytest.mark.parametrize(("place", "pairs"), [(3.0, 0), (0.0, 8)])
def test_sides_that_may_cross_are_counted_before_the_floor_is_cut(
    monkeypatch, place, pairs
):
    """Those of different outlines, from either side."""
    sizes = {"center": [0.0, 0.0], "size": [2.0, 0.1]}, {"size": [0.1, 2.0]}
    boxes = [{"kind": "box", **sizes[0], **more} for more in ({}, sizes[1])]
    boxes[1]["center"] = [place, place]
    monkeypatch.setattr(obstacles, "MOST_PAIRS", pairs)
    assert len(obstacles.decode(boxes)) == 2
    monkeypatch.setattr(obstacles, "MOST_PAIRS", pairs - 1)
    with pytest.raises(UsageError, match="too many sides cross one another"):
        obstacles.decode(boxes)


def test_as_many_corners_poses_numbers_and_arrays_as_are_most_are_taken(
    monkeypatch, tmp_path
):
    boxes = [{"kind": "box", "center": [k, 0.0], "size": [0.1, 0.1]} for k in (1, 2, 3)]
    monkeypatch.setattr(obstacles, "MOST_CORNERS", 2)
    assert len(obstacles.decode(boxes[:2])) == 2
    with pytest.raises(UsageError, match="3 points of obstacles"):
        obstacles.decode(boxes)
    rows = ["0,0,0", "1,0,0", "2,0,0"]
    monkeypatch.setattr(body_path, "MOST_POSES", 2)
    head = ",".join(body_path.POSE)
    assert len(body_path._poses_in("\n".join([head, *rows[:2]]))) == 2
    with pytest.raises(ValueError, match="more than 2 poses"):
        body_path._poses_in("\n".join([head, *rows]))
    monkeypatch.setattr(logs, "MOST_NUMBERS", 4)
    for count in (2, 3):
        (tmp_path / "log.csv").write_text("time,a\n" + "1,2\n" * count)
        if count == 2:
            assert len(logs._table(tmp_path / "log.csv")["a"]) == 2
        else:
            with pytest.raises(ValueError, match="more than 4 numbers"):
                logs._table(tmp_path / "log.csv")
    np.savez(tmp_path / "two.npz", a=np.zeros(3), b=np.zeros(2))
    with zipfile.ZipFile(tmp_path / "two.npz") as archive:
        size = sum(member.file_size for member in archive.infolist())
        monkeypatch.setattr(arrays, "UNPACKED", size)
        monkeypatch.setattr(arrays, "MOST_ARRAYS", 2)
        assert [*arrays._declared(archive, "it")] == [("a", (3,)), ("b", (2,))]
        for name, most in (("UNPACKED", size - 1), ("MOST_ARRAYS", 1)):
            with monkeypatch.context() as less:
                less.setattr(arrays, name, most)
                with pytest.raises(ValueError, match="are the most"):
                    [*arrays._declared(archive, "it")]


def test_a_walk_may_take_all_steps_and_all_memory_that_there_are(monkeypatch):
    scenario = SimpleNamespace(sample_every=1, name="it")
    setup = SimpleNamespace(scenario=scenario)
    monkeypatch.setattr(scheduling, "MOST_STEPS", 100)
    monkeypatch.setattr(scheduling, "_row_size", lambda _: 1)
    monkeypatch.setattr(scheduling, "_memory", lambda: 100)
    monkeypatch.setattr(scheduling, "_slowest", lambda _: "walk faster")
    scheduling.check_effort(setup, 100)
    with pytest.raises(UsageError, match="walk faster"):
        scheduling.check_effort(setup, 101)
    monkeypatch.setattr(scheduling, "_memory", lambda: 50)
    with pytest.raises(UsageError, match="raise sample_every above 2"):
        scheduling.check_effort(setup, 100)


def test_an_end_is_told_from_a_twentieth_of_a_stage_on_until_it_ends():
    for part, told in ((0.9 * TELLING, False), (TELLING, True), (1.0, False)):
        stage = Pace(0.0)
        stage.report(part, 10.0)
        assert bool(stage.left(10.0)) == told


def test_words_are_white_on_colours_darker_than_a_hundred():
    assert Colour(150, 100, 0).ink == TEXT
    assert Colour(145, 100, 0).ink == WHITE


def test_poses_go_as_far_as_a_million():
    assert _pose('{"time": 1, "x": 1e6, "y": -1e6}')[1][:2] == [1e6, -1e6]
    with pytest.raises(ValueError, match="beyond 1e6"):
        _pose('{"time": 1, "x": 1000000.5}')


def test_two_points_are_a_trajectory_and_one_is_none():
    point = "- {{positions: [0.1], time_from_start: {{sec: {}, nanosec: 0}}}}\n"
    text = "joint_names: [a]\npoints:\n" + point.format(0)
    assert read_trajectory(text + point.format(2)).rate == pytest.approx(0.5)
    with pytest.raises(ValueError, match="two points at least"):
        read_trajectory(text)


def test_twenty_rows_are_enough_to_fit_and_nineteen_are_not(tmp_path):
    def log(rows):
        measured = np.zeros((rows, 1))
        return SimpleNamespace(time=np.arange(rows), measured=measured, commanded=1)

    check_measured(tmp_path, log(FEWEST_ROWS))
    with pytest.raises(UsageError, match="fewer than 20 rows"):
        check_measured(tmp_path, log(FEWEST_ROWS - 1))


def test_a_log_of_goals_in_place_of_positions_is_not_fitted(tmp_path):
    """Servos that follow to the last digit would come out as stiff as can be."""
    asked = np.linspace(0, 1, FEWEST_ROWS)[:, None]
    measured = np.where(asked < 0.5, np.nan, asked)
    log = SimpleNamespace(time=asked[:, 0], measured=measured, commanded=asked)
    with pytest.raises(UsageError, match="log positions of servos, not their goals"):
        check_measured(tmp_path, log)
    log.measured = measured + 1e-9
    check_measured(tmp_path, log)


def test_a_joint_of_which_little_was_measured_is_not_fitted(tmp_path):
    """A single angle is met by a zero, as exactly as you like."""
    measured = np.zeros((40, 3))
    measured[:, 1], measured[13:30, 2] = np.nan, np.nan  # 1 to 29 are fitted
    log = SimpleNamespace(time=np.arange(40), measured=measured, joints=("a", "b", "c"))
    said = "12 measured angles of joint 'c', of which at least 13 .*: x; leave out its"
    with pytest.raises(UsageError, match=said):
        check_told(Path("x"), [log])
    check_told(Path("x"), [log, log])  # which tell enough together
    measured[13, 2] = 0.0
    check_told(Path("x"), [log])
    check_told(Path("x"), [SimpleNamespace(measured=None, joints=("a",))])


def test_contacts_of_feet_with_fewer_geoms_are_real_as_far_as_they_go(monkeypatch):
    monkeypatch.setattr("sim.physics.measure.contact_sensor", str)
    size = CONTACT_FIELDS
    sensors = {"a": 0, "b": 10 * size, "c": 20 * size}
    model = SimpleNamespace(
        sensor=lambda name: SimpleNamespace(adr=[sensors[name]], dim=[size])
    )
    legs = [SimpleNamespace(foot=foot) for foot in (("a",), ("b", "c"))]
    slots = _slots(model, SimpleNamespace(leg_cards=legs))
    assert [(at.tolist(), real.tolist()) for at, real in slots] == [
        ([0, 10 * size], [True, True]),
        ([0, 20 * size], [False, True]),
    ]


def test_as_many_designs_are_walked_as_are_asked_for(monkeypatch):
    found = [SimpleNamespace(joints=6, built=lambda robot: "built") for _ in range(3)]
    monkeypatch.setattr(designing, "directions", lambda *_: designing.DIRECTIONS)
    monkeypatch.setattr(designing, "_checked", lambda _: {"status": "ok"})
    monkeypatch.setattr(designing, "_walked", lambda _: {"status": "walked"})
    robot = SimpleNamespace(legs=range(6))
    for walks in (0, 2):
        rows = [*designing.tried(robot, found, walks)]
        assert [row["status"] == "walked" for row in rows] == [
            number < walks for number in range(3)
        ]
