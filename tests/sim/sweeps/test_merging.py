"""Where a merged sweep goes: its own folder, a new one, but nobody else's."""

import json

import pytest

from sim.cli import main
from sim.sweeps.file import read_sweep
from sim.sweeps.folder import About, Shard, SweepFolder
from sim.sweeps.ledger import OK, Outcome, opened, software
from sim.sweeps.sweeping import points_of
from tests.sweeps import write_sweep


@pytest.fixture
def finished(tmp_path):
    """Makes the folder of a sweep, or shard, as if its points had been walked."""

    def make(name, friction, shard=None):
        sweep = read_sweep(
            str(write_sweep(tmp_path, f"[grid]\nfriction = {friction}\n", name))
        )
        folder = SweepFolder(tmp_path / name, shard or Shard())
        folder.path.mkdir(exist_ok=True)
        folder.agree(About.of(sweep), mix=False)
        with opened(folder.ledger) as ledger:
            for code in points_of(sweep, folder.shard).digests.values():
                ledger.add([Outcome(code, OK, {"strokes": 1.0}, software())])
        return folder.path

    return make


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def merged(*folders, out):
    return main(["merge", *map(str, folders), "--out", str(out)])


def test_the_folder_of_another_sweep_is_kept_as_it_is(finished, capsys):
    one, other = finished("one", [0.4, 1.0]), finished("other", [0.5, 0.6])
    assert merged(other, out=other) == 0
    before = contents(other)
    capsys.readouterr()
    assert merged(one, out=other) == 2
    said = capsys.readouterr().err
    assert "not of one sweep, vary.friction: [0.4, 1.0], now [0.5, 0.6]: " in said
    assert f"{other / 'sweep.json'}; " in said
    assert contents(other) == before


def test_a_shard_of_another_sweep_keeps_its_folder_to_itself(finished):
    one, other = finished("one", [0.4, 1.0]), finished("other", [0.5], Shard(1, 2))
    before = contents(other)
    assert merged(one, out=other) == 2
    assert contents(other) == before


def test_a_sweep_is_merged_into_its_own_folder_again_and_again(finished, tmp_path):
    one, both = finished("one", [0.4, 1.0]), tmp_path / "both"
    assert merged(one, out=both) == 0
    before = contents(both)
    assert merged(one, out=both) == 0
    assert contents(both) == before
    assert merged(both, out=one) == 0
    assert (one / "table.parquet").read_bytes() == before["table.parquet"]


def test_shards_of_machines_with_other_kernels_make_one_table(finished, tmp_path):
    one, two = (finished("nodes", [0.4, 1.0], Shard(n, 2)) for n in (1, 2))
    said = (two / "sweep-2-of-2.json").read_text()
    about = json.loads(said) | {"software": software() | {"system": "Linux-0"}}
    (two / "sweep-2-of-2.json").write_text(json.dumps(about))
    assert merged(one, out=tmp_path / "all") == 0
    assert not json.loads((tmp_path / "all" / "sweep.json").read_text())["mixed"]


def test_shards_may_lie_in_the_folder_that_they_are_merged_into(finished, tmp_path):
    for number in (1, 2):
        folder = finished("one", [0.4, 1.0], Shard(number, 2))
    assert merged(folder, out=folder) == 0
    assert merged(folder, out=folder) == 0


def test_the_part_that_lacks_a_point_is_named(finished, capsys):
    for number in (1, 2):
        folder = finished("one", [0.4, 1.0], Shard(number, 2))
        (folder / f"table-{number}-of-2.parquet").touch()
    (folder / "ledger-2-of-2.jsonl").write_text("")
    assert merged(folder, out=folder) == 2
    assert f"--out {folder} --shard 2/2 --resume" in capsys.readouterr().err
    (folder / "table-1-of-0.parquet").touch()  # of no shard
    assert merged(folder, out=folder) == 2


def test_the_table_of_something_else_is_not_replaced(finished, tmp_path, capsys):
    (table := tmp_path / "mine" / "table.parquet").parent.mkdir()
    table.write_text("mine")
    (table.parent / "sweeps.json").write_text("mine")
    assert merged(finished("one", [0.4]), out=table.parent) == 2
    assert f"already exists: {table}; give --out" in capsys.readouterr().err
    assert table.read_text() == "mine"
    assert len(contents(table.parent)) == 2
