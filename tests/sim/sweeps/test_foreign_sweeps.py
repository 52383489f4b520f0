"""Sweeps of strangers: resealed lines, other software, two results of one point."""

import json
import re
import shutil

import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.sweeps import sweeping
from sim.sweeps.file import read_sweep
from sim.sweeps.folder import Shard
from sim.sweeps.ledger import LENGTH, _sealed
from sim.sweeps.sweeping import points_of
from tests.commands import forbidden
from tests.sweeps import walked_here, write_sweep

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A finished sweep of two points: its file and its folder."""
    folder = tmp_path_factory.mktemp("swept")
    file = write_sweep(folder, "[grid]\nfriction = [0.4, 1.0]\n")
    done = walked_here("sweep", file, "--out", folder / "out")
    assert done.returncode == 0, done.stderr
    return file, folder / "out"


@pytest.fixture
def again(swept, tmp_path):
    """A copy of the sweep's folder, to be spoilt, and its file."""
    return swept[0], shutil.copytree(swept[1], tmp_path / "copy")


def resealed(ledger, change):
    """A ledger whose first line was changed by a stranger who knows how to seal."""
    first, *rest = ledger.read_bytes().splitlines(keepends=True)
    content = b"{" + first[LENGTH:-1]
    changed = _sealed(re.sub(*change, content, count=1))
    assert changed != first
    ledger.write_bytes(b"".join([changed, *rest]))


def test_a_line_of_other_software_is_refused_unless_the_sweep_is_mixed(again, capsys):
    file, folder = again
    resealed(folder / "ledger.jsonl", (rb'"mujoco": "[^"]*"', b'"mujoco": "3.9.0"'))
    going_on = ["sweep", str(file), "--out", str(folder), "--resume"]
    for words in (going_on, ["merge", str(folder)]):
        assert main(words) == 2
        assert "it is of other software, mujoco: " in capsys.readouterr().err
    for words in ([*going_on, "--force-mix"], going_on, ["merge", str(folder)]):
        assert main(words) == 0


def test_two_results_of_one_point_are_not_merged(again, swept, tmp_path, capsys):
    _, folder = again
    resealed(folder / "ledger.jsonl", (rb'("path_length": )0', rb"\g<1>9"))
    words = ["merge", str(swept[1]), str(folder), "--out", str(tmp_path / "o")]
    assert main(words) == 2
    said = capsys.readouterr().err
    assert re.search(r"point \d has two results, path_length: 0\S*, now 9", said)
    assert not (tmp_path / "o" / "table.parquet").exists()


@pytest.mark.parametrize("mujoco", [5, None, {}])
def test_versions_that_are_no_texts_are_not_merged(again, capsys, mujoco):
    _, folder = again
    about = json.loads((folder / "sweep.json").read_text())
    about["software"]["mujoco"] = mujoco
    (folder / "sweep.json").write_text(json.dumps(about))
    assert main(["merge", str(folder)]) == 2
    assert "sweep.json; choose another folder" in capsys.readouterr().err


def test_a_sweep_that_takes_too_long_to_check_has_fewer_points(tmp_path, monkeypatch):
    file = write_sweep(
        tmp_path, "[grid]\nfriction = { from = 0.5, to = 1, count = 30 }\n"
    )
    sweep = read_sweep(file)
    assert len(points_of(sweep, Shard()).tables) == 30
    monkeypatch.setattr(sweeping, "SURE", 0.0)
    monkeypatch.setattr(sweeping, "MOST_TIME", 1e-3)  # a point takes 0.2 ms or more
    with pytest.raises(UsageError, match=r"30 points: .* sweeps of at most \d points"):
        points_of(sweep, Shard())
    monkeypatch.setattr(sweeping, "SURE", 100.0)
    assert len(points_of(sweep, Shard()).tables) == 30


def test_tables_and_folders_that_may_not_be_read_are_named_with_that_reason(again):
    _, folder = again
    (folder / "table.parquet").chmod(0)
    done = forbidden("study", folder)
    said = f"error: Permission denied: {folder}"
    assert (done.returncode, f"{said}/table.parquet; " in done.stderr) == (6, True)
    for mode in (0, 0o111):
        folder.chmod(mode)
        done = forbidden("merge", folder)
        assert (done.returncode, f"{said}; " in done.stderr) == (6, True), done.stderr
    folder.chmod(0o755)
