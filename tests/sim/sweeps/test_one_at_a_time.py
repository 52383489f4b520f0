"""A sweep's folder is changed by one process at a time, which says what it has kept."""

import os
import shutil
import subprocess
from contextlib import redirect_stdout

import pytest

from sim.cli import main
from sim.sweeps.folder import sole_owner
from tests.commands import COMMAND, told
from tests.sweeps import walked_here, write_sweep

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """The file of a finished sweep of one point, and its folder."""
    folder = tmp_path_factory.mktemp("swept")
    file = write_sweep(folder, "[grid]\nfriction = [1.0]\n")
    done = walked_here("sweep", file, "--out", folder / "out")
    assert done.returncode == 0, done.stderr
    return file, folder / "out"


def test_a_full_disk_under_the_last_words_leaves_the_way_to_them(swept, capsys):
    file, folder = swept
    words = ["sweep", str(file), "--out", str(folder), "--resume", "--json"]
    with open("/dev/full", "w") as full, redirect_stdout(full):
        assert main(words) == 6
    (line,) = told(capsys.readouterr().err)
    assert "No space left on device: standard output; free some space; " in line
    assert line.endswith(f"kept in {folder}; go on: stratawalk {' '.join(words)}")


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_sweep_is_walked_to_its_end_where_nobody_reads_on(swept, tmp_path, stream):
    read, written = os.pipe()
    os.close(read)
    words = ["sweep", swept[0], "--out", tmp_path / "out"]
    done = subprocess.run([*COMMAND, *words], check=False, **{stream: written})
    os.close(written)
    assert done.returncode == 0
    assert (tmp_path / "out" / "table.parquet").is_file()


def test_nothing_is_merged_where_a_sweep_is_being_walked(swept, capsys):
    """Whoever cuts a torn line off takes the one that is just being written."""
    _, folder = swept
    ledger = folder / "ledger.jsonl"
    ledger.write_bytes(written := ledger.read_bytes() + b'{"seal": "half')
    with sole_owner(folder / "sweep.lock"):
        assert main(["merge", str(folder)]) == 6
    (line,) = told(capsys.readouterr().err)
    assert "is working on this sweep" in line
    assert ledger.read_bytes() == written
    assert main(["merge", str(folder)]) == 0


def test_a_sweep_without_its_table_is_told_to_end_first(swept, tmp_path, capsys):
    shutil.copy(swept[1] / "ledger.jsonl", tmp_path)
    assert main(["study", str(tmp_path)]) == 2
    (line,) = told(capsys.readouterr().err)
    assert "no such table: " in line
    assert "; end its sweep with --resume, or merge its shards" in line
