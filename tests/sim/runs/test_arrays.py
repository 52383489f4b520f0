"""Arrays of runs at the borders of what is read, and numbers of their summaries."""

import zipfile
from contextlib import nullcontext

import numpy as np
import pytest

from sim.errors import UsageError
from sim.runs.arrays import UNREADABLE, Arrays, archive, plain_json

MOST_ARRAYS = 100

FEET, MOMENTS = 2, 3
GOOD = {
    "time": np.arange(3.0),
    "achieved_margin": np.array([0.1, -np.inf, 0.2]),
    "contact": np.ones((3, 2), dtype=bool),
    "contact_point": np.ones((3, 2, 2)),
    "achieved_pose": np.zeros((3, 3)),
    "center_of_mass": np.zeros((3, 3)),
    "qpos": np.full((3, 9), 0.999e9),
    "start": np.zeros(3),
}


@pytest.fixture(autouse=True)
def finished(monkeypatch):
    """Folders count as finished runs, though they hold arrays alone."""
    monkeypatch.setattr("sim.runs.arrays.reading", lambda folder: nullcontext())


def opened(folder, check=True, apart=("start",), **changes):
    kept = {k: v for k, v in (GOOD | changes).items() if v is not None}
    np.savez(folder / "a.npz", **kept)
    return archive(folder, "a.npz", FEET, apart, check)


def test_good_arrays_are_read_when_they_are_asked_for(tmp_path):
    found = opened(tmp_path)
    assert {*found} == {*GOOD}
    assert len(found) == len(GOOD)
    for name, array in GOOD.items():
        assert (found[name] == array).all()
    with pytest.raises(KeyError):
        found["other"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"achieved_margin": np.array([0.1, np.nan, 0.2])}, "margin of a.npz is not"),
        ({"achieved_margin": np.array([0.1, np.inf, 0.2])}, "not finite or beyond 1e"),
        ({"achieved_margin": np.array([0.1, -1e9, 0.2])}, "beyond 1e"),
        ({"qpos": np.full((3, 9), -np.inf)}, "qpos of a.npz is not finite"),
        ({"qpos": np.full((3, 9), 1e9)}, "qpos of a.npz is not finite or beyond 1e"),
        (
            {"qpos": np.full((3, 9), -(2**63))},  # whose amount is none of its kind
            "qpos of a.npz is not finite or beyond 1e",
        ),
        ({"time": np.arange(4.0)}, "different numbers of rows"),
        ({"time": np.zeros(())}, "different numbers of rows"),
        ({"contact": np.ones((3, 3), bool)}, r"shape \(3,\) instead of \(2,\)"),
        ({"contact_point": np.ones((3, 3, 2))}, r"shape \(3, 2\) instead of \(2, 2\)"),
        ({"achieved_pose": np.zeros((3, 2))}, r"shape \(2,\) instead of \(3,\)"),
        ({"time": np.zeros((3, 1))}, r"shape \(1,\) instead of \(\)"),
        ({"time": np.array(["a", "b", "c"])}, "time of .* has <U1 in place of f8"),
        ({"achieved_pose": np.zeros((3, 3), np.int8)}, "has int8 in place of f8"),
        ({"contact": np.zeros((3, 6))}, "contact of .* has float64 in place of b1"),
        ({"time": np.zeros(3, complex)}, "time of .* has complex128 in place of f8"),
    ],
)  # fmt: skip
def test_arrays_that_no_walk_has_are_refused(tmp_path, changes, said):
    with pytest.raises((ValueError, UsageError), match=said):
        opened(tmp_path, **changes)


def test_numbers_are_looked_at_once_for_a_check_and_else_as_they_are_read(tmp_path):
    found = opened(tmp_path, check=False, qpos=np.full((3, 9), np.nan))
    assert found["time"].tolist() == [0, 1, 2]
    with pytest.raises((ValueError, UsageError), match="qpos of a.npz"):
        found["qpos"]


@pytest.mark.parametrize("count", [MOST_ARRAYS, MOST_ARRAYS + 1])
def test_a_file_has_a_hundred_arrays_at_most(tmp_path, count):
    np.savez(tmp_path / "a.npz", **{f"q{k}": np.zeros((2, 1)) for k in range(count)})
    if count > 100:
        with pytest.raises(
            ValueError, match="declares 101 arrays .* 100 of 0.5 GB are"
        ):
            archive(tmp_path, "a.npz", FEET, (), check=True)
    else:
        assert len(archive(tmp_path, "a.npz", FEET, (), check=True)) == 100


def test_a_file_without_rows_or_packed_in_another_way_is_refused(tmp_path):
    with pytest.raises((ValueError, UsageError), match="different numbers of rows"):
        opened(tmp_path, **{k: v[:0] for k, v in GOOD.items() if k != "start"})
    path = tmp_path / "b.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_BZIP2) as file:
        file.writestr("time.npy", b"x" * 100)
    with pytest.raises(ValueError, match="time of b.npz is packed in an unknown way"):
        archive(tmp_path, "b.npz", FEET, (), check=True)


def test_arrays_are_computed_when_they_are_asked_for():
    made = []
    arrays = Arrays(("a", "b"), lambda name: made.append(name) or np.zeros(1))
    assert made == []
    assert arrays["b"].tolist() == [0.0]
    assert made == ["b"]
    assert list(arrays) == ["a", "b"]
    assert KeyError in UNREADABLE


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b'{"a": 999999999.0}', ""), (b'{"a": 1e9}', "1e9 is not a number below 1e"),
        (b'{"a": -1e9}', "-1e9 is not a number"),
        (b'{"a": NaN}', "NaN is not a number"),
        (b'{"a": Infinity}', "Infinity is not"),
        (b"[1]", "summary.json holds no table"),
        (b'{"a": 1,\n}', "summary.json is no JSON, line 2"),
    ],
)  # fmt: skip
def test_numbers_of_a_summary_are_below_a_thousand_million(text, said):
    if said:
        with pytest.raises(ValueError, match=said):
            plain_json(text)
    else:
        assert plain_json(text) == {"a": 999999999.0}
