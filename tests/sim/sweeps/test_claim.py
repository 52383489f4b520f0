"""Whose a folder is in which a sweep is to be walked."""

import pytest

from sim.errors import UsageError
from sim.sweeps.folder import Shard, claim

FIRST = Shard(1, 2)


@pytest.fixture
def holding(tmp_path):
    def make(*names):
        for name in names:
            (tmp_path / name).touch()
        return tmp_path

    return make


@pytest.mark.parametrize("left", ["sweep.json", "ledger.jsonl"])
def test_a_sweep_of_which_anything_is_written_down_is_not_begun_again(holding, left):
    folder = holding("sweep.lock", left)
    with pytest.raises(UsageError, match="give --resume to go on with it"):
        claim(folder, Shard(), resume=False)
    assert claim(folder, Shard(), resume=True).path == folder


def test_a_ledger_alone_is_a_sweep_to_go_on_with(holding):
    folder = holding("ledger.jsonl")
    assert claim(folder, Shard(), resume=True).path == folder
    with pytest.raises(UsageError, match="give --resume to go on with it"):
        claim(folder, Shard(), resume=False)


def test_a_sweep_that_was_ended_before_it_wrote_anything_is_begun(holding):
    assert claim(holding("sweep.lock"), Shard(), resume=False).about.name


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize("name", ["notes.txt", "sweeps.txt", "sweep-ideas.json"])
def test_a_folder_of_something_else_is_refused(holding, name, resume):
    folder = holding(name, "table.parquet")
    with pytest.raises(UsageError, match="already exists.*choose another folder"):
        claim(folder, Shard(), resume)


def test_an_empty_folder_will_do_for_shards_and_to_resume_alone(holding, tmp_path):
    assert claim(holding(), FIRST, resume=False).path == tmp_path
    assert claim(holding(), Shard(), resume=True).path == tmp_path
    with pytest.raises(UsageError, match="choose another folder"):
        claim(holding(), Shard(), resume=False)


def test_shards_share_a_folder(holding):
    folder = holding("sweep-2-of-2.json")
    assert claim(folder, FIRST, resume=False).path == folder
