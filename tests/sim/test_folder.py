"""Run folders: claimed once, and files in them whole or absent."""

import errno
import json
import os
import subprocess
import sys
import threading
from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest

from sim.commands.export import _require_sense
from sim.errors import FilesError, UsageError
from sim.fitting.fitting import check_free
from sim.folder import Pieces, RunFolder, claim, ensure_folder, whole


def names(folder):
    return sorted(entry.name for entry in folder.iterdir())


def write_half(path, error):
    with whole(path, size=2_000_000) as part:
        part.write_text("half")
        raise error


def test_runs_are_numbered_by_scenario(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = [claim(None, name).path for name in ("line", "line", "ellipse", "line")]
    assert [str(path) for path in made] == [
        "runs/line-001",
        "runs/line-002",
        "runs/ellipse-001",
        "runs/line-003",
    ]


def test_number_is_one_above_the_highest_there_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for taken in ("line-007", "line-x", "pipeline-012", "line-1000"):
        (tmp_path / "runs" / taken).mkdir(parents=True)
    assert str(claim(None, "line").path) == "runs/line-1001"


def test_runs_started_together_get_folders_of_their_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = []
    ask = [
        threading.Thread(target=lambda: made.append(claim(None, "line")))
        for _ in range(8)
    ]
    for thread in ask:
        thread.start()
    for thread in ask:
        thread.join()
    assert len({folder.path for folder in made}) == 8


def test_a_folder_in_which_nothing_is_written_goes_with_what_was_made_for_it(tmp_path):
    (tmp_path / "own").mkdir()
    claim(tmp_path / "own" / "a" / "b", "line").discard_if_empty()
    assert names(tmp_path / "own") == []
    kept = claim(tmp_path / "own" / "a" / "b", "line")
    claim(tmp_path / "own" / "a" / "c", "line").discard_if_empty()
    assert names(tmp_path / "own" / "a") == [kept.path.name]


def test_claimed_folder_is_empty(tmp_path):
    assert names(claim(tmp_path / "new" / "run", "line").path) == []


@pytest.mark.parametrize("make", ["mkdir", "touch"])
def test_existing_folder_or_file_is_refused_as_bad_usage(tmp_path, make):
    getattr(tmp_path / "taken", make)()
    with pytest.raises(UsageError, match="already exists: .*taken; give --out"):
        claim(tmp_path / "taken", "line")


def test_folder_below_a_file_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(FilesError, match="cannot make the run folder, .*--out"):
        claim(tmp_path / "file" / "run", "line")


def test_folder_that_cannot_be_made_is_refused():
    with pytest.raises(FilesError, match="cannot make the run folder, .*: /proc/run;"):
        claim(Path("/proc/run"), "line")


def test_a_folder_in_which_no_file_can_be_made_is_refused_before_work_for_it(tmp_path):
    """Whether it is for pages and pictures, for a card, or for exported commands."""
    places = {
        ensure_folder: Path("/proc"),
        check_free: Path("/proc/mine.toml"),
        lambda file: _require_sense(
            Namespace(microseconds=False, out=str(file)), file
        ): Path("/proc/walk.csv"),
    }
    for refuse, place in places.items():
        with pytest.raises(FilesError, match="cannot be written, .*: /proc; choose a"):
            refuse(place)
    assert ensure_folder(tmp_path / "new") == tmp_path / "new"
    assert names(tmp_path / "new") == []


@pytest.mark.parametrize("name", ["two words", "größe", "new\nline"])
def test_any_name_of_a_folder_will_do(tmp_path, name):
    folder = claim(tmp_path / name, "line")
    folder.write_text("note.txt", "here")
    assert (tmp_path / name / "note.txt").read_text() == "here"


def test_a_folder_that_is_interrupted_as_it_is_claimed_leaves_its_name_free(
    tmp_path, monkeypatch
):
    def interrupted(_):
        raise KeyboardInterrupt

    monkeypatch.setattr("sim.folder.require_writable", interrupted)
    with pytest.raises(KeyboardInterrupt):
        claim(tmp_path / "new" / "run", "line")
    assert names(tmp_path) == []


def test_json_reads_back_unrounded(tmp_path):
    numbers = {"third": 1 / 3, "list": [0.1, 1e-300]}
    RunFolder(tmp_path).write_json("summary.json", numbers)
    assert json.loads((tmp_path / "summary.json").read_text()) == numbers


def test_json_has_no_nan(tmp_path):
    with pytest.raises(ValueError, match="not JSON compliant"):
        RunFolder(tmp_path).write_json("summary.json", {"slip": float("nan")})
    assert names(tmp_path) == []


def test_arrays_read_back_and_equal_arrays_give_equal_bytes(tmp_path):
    arrays = {"time": np.arange(5.0), "contact": np.eye(3, dtype=bool)}
    for name in ("a.npz", "b.npz"):
        RunFolder(tmp_path).write_arrays(name, arrays.items())
    with np.load(tmp_path / "a.npz", allow_pickle=False) as read:
        assert {key: read[key].tolist() for key in read} == {
            key: array.tolist() for key, array in arrays.items()
        }
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_file_that_fails_halfway_leaves_what_was_there_before(tmp_path):
    (tmp_path / "a.txt").write_text("before")
    with pytest.raises(ZeroDivisionError):
        write_half(tmp_path / "a.txt", ZeroDivisionError())
    assert names(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "before"


def test_process_that_dies_halfway_leaves_no_file_under_its_name(tmp_path):
    program = (
        "import os, pathlib, sim.folder\n"
        f"with sim.folder.whole(pathlib.Path({str(tmp_path / 'a.txt')!r})) as part:\n"
        "    part.write_text('half')\n"
        "    os._exit(9)\n"
    )
    assert subprocess.run([sys.executable, "-c", program]).returncode == 9
    assert "a.txt" not in names(tmp_path)
    assert len(names(tmp_path)) == 1


def test_file_too_large_for_the_disk_is_refused_with_its_size(tmp_path):
    with (
        pytest.raises(FilesError, match=r"disk full, 10{12}\.0 MB needed: .*a.npz"),
        whole(tmp_path / "a.npz", size=10**18),
    ):
        pass
    assert names(tmp_path) == []


def test_work_that_there_is_no_room_for_is_refused(tmp_path):
    RunFolder(tmp_path).reserve(1000)
    with pytest.raises(FilesError, match=r"disk full, 10{12}\.0 MB needed"):
        RunFolder(tmp_path).reserve(10**18)


def test_disk_that_fills_up_halfway_leaves_no_file(tmp_path):
    full = OSError(errno.ENOSPC, "No space left on device")
    with pytest.raises(FilesError, match=r"disk full, 2\.0 MB needed: .*; free some"):
        write_half(tmp_path / "a.npz", full)
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    ("size", "told"), [(321, "0.3 kB"), (99_900, "99.9 kB"), (160_000, "0.2 MB")]
)
def test_a_full_disk_says_how_much_room_a_small_file_needs(tmp_path, size, told):
    with (
        pytest.raises(FilesError, match=f"disk full, {told} needed: .*; free some"),
        whole(tmp_path / "report.html", size),
    ):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_advice_on_files_is_in_words_that_every_command_can_follow(tmp_path):
    """As `show` and `view --replay`, which have no `--out`."""
    for number, remedy in (
        (errno.ENOSPC, "free some space, or write to another disk"),
        (errno.EACCES, "choose a folder that can be written"),
    ):
        with (
            pytest.raises(FilesError, match=f"; {remedy}$"),
            whole(tmp_path / "report.html"),
        ):
            raise OSError(number, os.strerror(number))


def test_folder_that_vanished_is_an_error_of_the_file_system(tmp_path):
    with pytest.raises(FilesError, match="cannot be written, No such file"):
        RunFolder(tmp_path / "gone").write_text("a.txt", "")


def test_only_an_empty_folder_is_discarded(tmp_path):
    empty, full = claim(tmp_path / "empty", "line"), claim(tmp_path / "full", "line")
    full.write_text("a.txt", "")
    for folder in (empty, full):
        folder.discard_if_empty()
    assert names(tmp_path) == ["full"]


def test_a_disk_that_fills_up_is_told_how_much_the_file_may_need(tmp_path):
    with (
        pytest.raises(FilesError, match=r"disk full, up to 5\.0 MB needed: .*a.npz"),
        whole(tmp_path / "a.npz", at_most=lambda: 5_000_000),
    ):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_what_arrays_may_need_counts_those_not_yet_written(tmp_path):
    def arrays():
        yield "first", np.zeros(1000)
        yield "second", Pieces((250_000, 2), _full())
        yield "third", np.zeros(125_000)

    with pytest.raises(FilesError, match=r"disk full, up to 5\.0 MB needed"):
        RunFolder(tmp_path).write_arrays("a.npz", arrays())


def _full():
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    yield


def test_of_two_who_write_one_new_file_the_second_is_refused(tmp_path):
    """Both began before the name was taken."""
    path = tmp_path / "new.csv"

    def write_twice():
        with whole(path, new=True) as first:
            first.write_text("first")
            with whole(path, new=True) as second:
                second.write_text("second")

    with pytest.raises(UsageError, match="already exists: .*new.csv; give another"):
        write_twice()
    assert path.read_text() == "second"
    assert names(tmp_path) == ["new.csv"]


def test_folders_that_mujoco_would_look_for_elsewhere_are_refused(tmp_path):
    with pytest.raises(UsageError, match="a backslash in a path.*; choose another"):
        claim(tmp_path / "a\\b" / "run", "line")
    with pytest.raises(UsageError, match="a backslash in a path.*; choose another"):
        ensure_folder(tmp_path / "a\\b" / "calibration")
    assert names(tmp_path) == []
