"""Whatever ends a process, finished points stay finished and torn lines do no harm."""

import json
import multiprocessing
import os
import signal
import time

import pytest

from sim.errors import FilesError
from sim.sweeps.folder import sole_owner
from sim.sweeps.ledger import OK, Outcome, opened, read_ledger

FIRST, SECOND = (Outcome(code, OK, {"x": 0.1}, {"mujoco": "1"}) for code in "ab")


def test_what_was_added_is_read_again_to_the_last_digit(tmp_path):
    third = Outcome("c", "no plan: none", {"x": 1 / 3})
    with opened(tmp_path / "ledger") as ledger:
        ledger.add([FIRST, SECOND])
        ledger.add([third])
    known = read_ledger(tmp_path / "ledger")
    assert known == {"a": FIRST, "b": SECOND, "c": third}


@pytest.mark.parametrize("cut", [1, 20, 60])
def test_a_torn_last_line_is_cut_off_and_nothing_else_is_lost(tmp_path, cut):
    path = tmp_path / "ledger"
    with opened(path) as ledger:
        ledger.add([FIRST, SECOND])
    path.write_bytes(path.read_bytes()[:-cut])
    assert read_ledger(path) == {"a": FIRST}
    with opened(path) as ledger:
        ledger.add([SECOND])
    assert read_ledger(path) == {"a": FIRST, "b": SECOND}
    assert all(json.loads(line) for line in path.read_text().splitlines())


def test_a_missing_ledger_knows_no_points(tmp_path):
    assert read_ledger(tmp_path / "ledger") == {}


def hold(path, held):
    with sole_owner(path):
        held.set()
        time.sleep(600)


@pytest.fixture
def owner(tmp_path):
    """Another process that holds the lock of a folder."""
    spawn = multiprocessing.get_context("spawn")
    held = spawn.Event()
    process = spawn.Process(target=hold, args=(tmp_path / "x.lock", held))
    process.start()
    assert held.wait(60)
    yield process
    process.kill()
    process.join(60)


def test_a_second_process_is_refused_and_told_of_the_first(tmp_path, owner):
    with (
        pytest.raises(FilesError, match=f"process {owner.pid} on .* is working"),
        sole_owner(tmp_path / "x.lock"),
    ):
        pass


def test_the_lock_of_a_killed_process_is_free_and_its_owner_known(tmp_path, owner):
    os.kill(owner.pid, signal.SIGKILL)
    owner.join(60)
    with sole_owner(tmp_path / "x.lock") as gone:
        assert gone.startswith(f"process {owner.pid} on")
    with sole_owner(tmp_path / "x.lock") as gone:
        assert gone is None
