"""A sweep that is killed again and again ends with the table of one that was not."""

import random
import signal
import subprocess
import time

import psutil
import pytest

from tests.sweeps import ENV, command, walked_here, write_sweep

pytestmark = pytest.mark.physics
SEED = 16


def lines(path):
    """How many points a ledger holds."""
    return path.read_bytes().count(b"\n") if path.exists() else 0


def wait_for(process, ledger, count, seconds):
    """Wait until a ledger holds so many points, and some seconds more."""
    while lines(ledger) < count and process.poll() is None:
        time.sleep(0.02)
    time.sleep(seconds)


def kill_a_worker(process, chance):
    """Kill one of the processes that a process has started, if there are any."""
    try:
        workers = psutil.Process(process.pid).children(recursive=True)
        chance.choice(workers).kill() if workers else None
    except psutil.NoSuchProcess:
        return


def killed(words, ledger, chance, more, number):
    """Run the command, kill one of its workers on the way, and then end the command.

    Args:
        words: Of the command.
        ledger: Of its sweep, which tells how far it is.
        chance: Where random moments come from.
        more: Points that it may add at most before it is ended.
        number: Signal that ends it.

    Returns:
        Its exit code.
    """
    process = subprocess.Popen(
        command(*words), env=ENV, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    before = lines(ledger)
    first, second = sorted(chance.randint(0, more) for _ in range(2))
    wait_for(process, ledger, before + first, chance.uniform(0.0, 1.0))
    kill_a_worker(process, chance)
    wait_for(process, ledger, before + second, chance.uniform(0.0, 1.0))
    process.send_signal(number)
    return process.wait(60)


@pytest.mark.parametrize(
    ("points", "times", "number"),
    [
        pytest.param(8, 1, signal.SIGKILL, id="few"),
        pytest.param(100, 20, signal.SIGKILL, id="hundred", marks=pytest.mark.full),
        pytest.param(100, 20, signal.SIGHUP, id="hung up", marks=pytest.mark.full),
        pytest.param(100, 20, signal.SIGTERM, id="ended", marks=pytest.mark.full),
        pytest.param(1000, 20, signal.SIGKILL, id="thousand", marks=pytest.mark.full),
    ],
)
def test_a_sweep_survives_being_killed(tmp_path, points, times, number):
    chance = random.Random(SEED)
    varies = f"[grid]\nfriction = {{ from = 0.2, to = 1.2, count = {points} }}\n"
    file = write_sweep(tmp_path, varies)
    out, ledger = tmp_path / "killed", tmp_path / "killed" / "ledger.jsonl"
    words = ("sweep", file, "--out", out, "--workers", 2, "--resume")
    counts, codes = [0], []
    for _ in range(times):
        codes.append(killed(words, ledger, chance, points // (times + 1), number))
        counts.append(lines(ledger))
    assert counts == sorted(counts)
    ended = {signal.SIGHUP: 129, signal.SIGTERM: 143}.get(number, -number)
    assert ended in codes
    assert set(codes) <= {0, ended, -number}  # Python itself may yet be starting
    for asked in (words, ("sweep", file, "--out", tmp_path / "plain")):
        done = walked_here(*asked)
        assert done.returncode == 0, done.stderr
    folders = (tmp_path / "plain", tmp_path / "killed")
    first, second = ((folder / "table.parquet").read_bytes() for folder in folders)
    assert first == second
