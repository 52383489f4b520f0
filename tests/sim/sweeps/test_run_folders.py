"""Run folders of chosen points are complete, or the sweep says what is wrong."""

import shutil

import pytest

from models.description import FOLDER
from sim.errors import FilesError, RenderError, UsageError
from sim.pictures import run_film
from sim.sweeps import folder as sweep_folder, sweeping
from sim.sweeps.file import read_sweep
from sim.sweeps.folder import Shard, SweepFolder, point_in, sole_owner
from sim.sweeps.sweeping import points_of, write_run_folders
from tests.sweeps import write_sweep

HALF = "out/runs/point-00000/half.npz"
VARIES = "[grid]\nfriction = [1.0]\n[keep]\npoints = [0]\nfilm = {film}\n"


def is_there(folder):
    """What stands for a run that can be read, where nothing has walked."""
    return (folder / "summary.json").exists()


@pytest.fixture
def walks_again(tmp_path, monkeypatch):
    """Keep a point of which a run folder exists: names of the folders walked again."""

    def walk(film, *files):
        monkeypatch.setattr(
            sweeping, "run", lambda _, made, **how: done.append(made.path)
        )
        monkeypatch.setattr(sweep_folder, "read_run", is_there)
        done = []
        sweep = read_sweep(str(write_sweep(tmp_path, VARIES.format(film=film))))
        runs = tmp_path / "out" / "runs" / "point-00000"
        runs.mkdir(parents=True, exist_ok=True)
        for name in files:
            (runs / name).touch()
        assert (
            write_run_folders(points_of(sweep, Shard()), SweepFolder(tmp_path / "out"))
            == []
        )
        return [path.name for path in done]

    return walk


def test_a_complete_folder_is_left_alone(walks_again):
    assert walks_again("false") == ["point-00000"]
    assert walks_again("false", "summary.json") == []


def test_a_folder_of_what_the_point_was_before_is_walked_anew(walks_again, tmp_path):
    """Its keys have changed places in the file, or its robot was edited."""
    known = tmp_path / "out" / "runs" / "point-00000" / "point.json"
    assert walks_again("false") == ["point-00000"]
    assert walks_again("false", "summary.json") == []
    known.write_text(known.read_text().replace('"of": "', '"of": "0'))
    assert walks_again("false", "summary.json") == ["point-00000"]
    for damaged in ("[]", "{", ""):
        known.write_text(damaged)
        assert walks_again("false", "summary.json") == ["point-00000"]
    known.unlink()
    assert walks_again("false", "summary.json") == ["point-00000"]


def test_a_finished_walk_whose_film_is_missing_is_filmed_where_it_is(
    walks_again, tmp_path, monkeypatch
):
    filmed, runs = [], tmp_path / "out" / "runs"
    monkeypatch.setattr(run_film, "film_folder", filmed.append)
    assert walks_again("false") == ["point-00000"]
    (runs / "point-00000" / "notes.md").write_text("mine")
    assert walks_again("true", "summary.json") == []
    assert filmed == [runs / "point-00000"]
    assert (runs / "point-00000" / "notes.md").read_text() == "mine"


def test_a_walk_whose_film_fails_is_not_walked_again(tmp_path, monkeypatch):
    def walk(_, made, **how):
        done.append(made.path.name)
        (made.path / "summary.json").touch()

    def refuse(_):
        raise RenderError("no picture", "here", "install a driver")

    done = []
    monkeypatch.setattr(sweeping, "run", walk)
    monkeypatch.setattr(sweep_folder, "read_run", is_there)
    monkeypatch.setattr(run_film, "film_folder", refuse)
    sweep = read_sweep(str(write_sweep(tmp_path, VARIES.format(film="true"))))
    given = points_of(sweep, Shard()), SweepFolder(tmp_path / "out")
    (tmp_path / "out").mkdir()
    for _ in range(2):
        (said,) = write_run_folders(*given)
        assert said == "point 0: no picture: here; install a driver"
    assert done == ["point-00000"]


def test_what_the_user_has_put_there_is_set_aside_and_an_unfinished_walk_removed(
    walks_again, tmp_path
):
    runs = tmp_path / "out" / "runs"
    assert walks_again("false", "notes.md") == ["point-00000"]
    assert walks_again("false", "summary.json", "notes.md", "scenario.toml") == []
    (runs / "point-00000" / "point.json").unlink()
    assert walks_again("false") == ["point-00000"]
    assert {path.parent.name for path in runs.glob("*/notes.md")} == {
        "point-00000.1", "point-00000.2",
    }  # fmt: skip
    assert walks_again("false", "scenario.toml") == ["point-00000"]
    assert len([*runs.iterdir()]) == 3


def test_one_process_at_a_time_makes_run_folders(walks_again, tmp_path):
    (tmp_path / "out").mkdir()
    busy = "is working on this sweep"
    with (
        sole_owner(SweepFolder(tmp_path / "out").lock),
        pytest.raises(FilesError, match=busy),
    ):
        walks_again("false", "half.npz")
    assert [*tmp_path.glob("out/runs/*/*")] == [tmp_path / HALF]
    assert walks_again("false") == ["point-00000"]


def test_nothing_is_removed_or_written_behind_a_link(walks_again, tmp_path):
    precious = tmp_path / "outside" / "point-00000" / "thesis.txt"
    precious.parent.mkdir(parents=True)
    precious.touch()
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "runs").symlink_to(tmp_path / "outside")
    with pytest.raises(UsageError, match="is a link, which may lead anywhere"):
        walks_again("false")
    assert precious.exists()


def test_a_robot_that_was_edited_meanwhile_does_not_walk_as_the_point(
    tmp_path, monkeypatch
):
    """The table has what its robot did as it was."""
    for name in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    own = f'[grid]\nrobot = ["{tmp_path / "hexapod.xml"}"]'
    varies = VARIES.format(film="false").replace("[grid]", own)
    sweep = read_sweep(str(write_sweep(tmp_path, varies)))
    given = points_of(sweep, Shard()), SweepFolder(tmp_path / "out")
    (tmp_path / "out").mkdir()
    monkeypatch.setattr(sweeping, "run", lambda *_, **__: None)
    assert write_run_folders(*given) == []
    (tmp_path / "hexapod.toml").write_text(
        (FOLDER / "hexapod.toml").read_text() + "#\n"
    )
    (said,) = write_run_folders(*given)
    assert said.startswith("point 0: the robot's or the motion's files are not those")


def test_a_full_disk_is_no_matter_of_one_point(tmp_path, monkeypatch):
    def full(*_, **__):
        raise FilesError("the disk is full", "here", "make room")

    monkeypatch.setattr(sweeping, "run", full)
    sweep = read_sweep(str(write_sweep(tmp_path, VARIES.format(film="false"))))
    with pytest.raises(FilesError, match="the disk is full"):
        write_run_folders(points_of(sweep, Shard()), SweepFolder(tmp_path / "out"))


@pytest.mark.physics
def test_a_run_that_was_changed_since_is_of_no_point(folder):
    (folder / "point.json").write_text('{"of": "x", "varied": {}}')
    assert point_in(folder) == {"of": "x", "varied": {}}
    summary = folder / "summary.json"
    before = summary.read_text()
    summary.write_text(before.replace('"bounces": 0', '"bounces": 1'))
    assert summary.read_text() != before
    assert point_in(folder) == {}
    assert point_in(folder / "none") == {}
