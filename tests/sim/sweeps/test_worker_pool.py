"""Workers that die, workers of a real Dask cluster, and workers with other software."""

import asyncio
import os
import random
import signal
import socket
import time
import warnings
from contextlib import suppress
from multiprocessing import forkserver
from threading import Thread

import pandas
import psutil
import pytest
from distributed import Future, rpc

from sim.cli import main
from sim.sweeps.file import read_sweep
from sim.sweeps.folder import Shard
from sim.sweeps.ledger import ALIKE, read_ledger, software
from sim.sweeps.sweeping import points_of
from sim.sweeps.worker_pool import Task, WorkerPool, open_pool
from sim.versions import PACKAGES
from tests.clusters import cluster
from tests.commands import Begun, told
from tests.sweeps import ENV, poisoned, stratawalk, walked_here, write_sweep

pytestmark = pytest.mark.physics
POISON = "[grid]\nfriction = [0.5, 0.666, 0.8]\n"


@pytest.fixture(autouse=True, scope="module")
def warm():
    """Commands are forked from what has loaded them, whatever pools load first."""
    forkserver.ensure_running()


def statuses(folder):
    return pandas.read_parquet(folder / "table.parquet")["status"].tolist()


def test_a_point_that_kills_its_worker_harms_no_other(tmp_path):
    file = write_sweep(tmp_path, POISON)
    env = poisoned(tmp_path)
    out = tmp_path / "out"
    done = stratawalk("sweep", file, "--out", out, "--workers", 1, env=env)
    assert done.returncode == 8, done.stderr
    first, deadly, last = statuses(out)
    assert (first, last) == ("ok", "ok")
    assert deadly == (
        "its worker died, 2 times: it was killed, or out of memory; "
        "--resume walks the point again"
    )
    again = stratawalk("sweep", file, "--out", out, "--workers", 1, "--resume")
    assert again.returncode == 0, again.stderr
    assert "3 points, 2 of them done before" in again.stdout
    assert statuses(out) == ["ok"] * 3
    merged = stratawalk("merge", out)
    assert merged.returncode == 0, merged.stderr


def test_solvers_are_part_of_what_a_point_was_made_with():
    assert {"casadi", "ompl"} < {*PACKAGES} < {*software()}
    assert {"casadi", "ompl"} < {*ALIKE}


def test_a_cluster_gives_the_bytes_that_one_machine_gives(tmp_path):
    file = write_sweep(tmp_path, "[grid]\nfriction = [0.5, 0.8]\n")
    here = walked_here("sweep", file, "--out", tmp_path / "here")
    assert here.returncode == 0, here.stderr
    with cluster(tmp_path) as address:
        there = ("sweep", file, "--out", tmp_path / "there", "--scheduler", address)
        done = stratawalk(*there)
        assert done.returncode == 0, done.stderr
        first, second = (tmp_path / n / "table.parquet" for n in ("here", "there"))
        assert first.read_bytes() == second.read_bytes()


@pytest.mark.full
def test_a_poisoned_point_harms_no_other_on_a_cluster_either(tmp_path):
    file = write_sweep(tmp_path, POISON)
    with cluster(tmp_path, poisoned(tmp_path), "--nanny") as address:
        out = tmp_path / "out"
        done = stratawalk("sweep", file, "--out", out, "--scheduler", address)
    assert done.returncode == 8, done.stderr
    first, deadly, last = statuses(out)
    assert (first, last) == ("ok", "ok")
    assert deadly.startswith("its worker died")


def test_workers_with_another_mujoco_get_no_points(tmp_path):
    file = write_sweep(tmp_path, "[grid]\nfriction = [0.5]\n")
    fake = tmp_path / "fake" / "mujoco-4.0.9.dist-info"
    fake.mkdir(parents=True)
    (fake / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: mujoco\nVersion: 4.0.9"
    )
    other = ENV | {"PYTHONPATH": f"{tmp_path / 'fake'}:{ENV['PYTHONPATH']}"}
    with cluster(tmp_path, other) as address:
        out = tmp_path / "out"
        done = stratawalk("sweep", file, "--out", out, "--scheduler", address)
    assert done.returncode == 8
    assert 'mujoco: "4.0.0", there "4.0.9"' in done.stderr
    assert not (out / "table.parquet").exists()


LACKING = """import sys
class Finder:
    def find_spec(self, name, *_):
        if name == "sim":
            raise ModuleNotFoundError("No module named 'sim'", name="sim")
sys.meta_path.insert(0, Finder())
"""


def test_a_worker_without_this_package_lives_on_and_is_told_of(tmp_path):
    """As in an environment of a cluster into which nobody has installed it."""
    file = write_sweep(tmp_path, "[grid]\nfriction = [0.5]\n")
    (tmp_path / "sitecustomize.py").write_text(LACKING)
    with cluster(tmp_path, ENV | {"PYTHONPATH": str(tmp_path)}) as address:
        for out in ("out", "again"):  # it has not ended
            words = ("sweep", file, "--out", tmp_path / out, "--scheduler", address)
            done = stratawalk(*words)
            assert done.returncode == 8
            assert "No module named 'sim'" in done.stderr
            assert "install the same versions everywhere" in done.stderr


def test_a_scheduler_that_is_lost_takes_no_point_with_it(tmp_path):
    file = write_sweep(tmp_path, "[grid]\nhold = [0.1, 60.0]\n")  # a second, a minute
    file.write_text(file.read_text().replace("hold = 0.1\n", "", 1))
    out = tmp_path / "out"
    ledger = out / "ledger.jsonl"
    with cluster(tmp_path) as address:
        words = ("sweep", file, "--out", out, "--scheduler", address)
        process = Begun(words, tmp_path)
        while process.poll() is None and not (ledger.exists() and ledger.read_bytes()):
            time.sleep(0.05)
        (mine,) = (
            found
            for found in psutil.net_connections("tcp4")
            if (found.laddr, found.status) == (listening(address), "LISTEN")
        )
        psutil.Process(mine.pid).kill()
        _, said = process.communicate(timeout=120)
    assert process.returncode == 8
    (line,) = told(said)
    assert line.startswith("stratawalk: error: the scheduler is gone, ")
    assert "1 of 2 points are done and kept in " in line
    assert line.endswith(f"go on: stratawalk {' '.join(map(str, words))} --resume")
    assert len(read_ledger(ledger)) == 1


def listening(address):
    """Host and port of an address."""
    host, _, port = address.removeprefix("tcp://").partition(":")
    return host, int(port)


@pytest.mark.parametrize(
    ("nobody", "said"),
    [
        ("tcp://127.0.0.1:9", "after 1 s"),
        ("tls://127.0.0.1:9", "got None"),
    ],
)
def test_a_scheduler_that_does_not_answer_is_refused(
    nobody, said, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr("sim.sweeps.worker_pool.ANSWER", 1.0)
    file = write_sweep(tmp_path, "[grid]\nfriction = [0.5]\n")
    words = ("sweep", file, "--out", tmp_path / "o", "--scheduler", nobody)
    assert main(list(map(str, words))) == 8
    (line,) = told(capsys.readouterr().err)
    assert f"{said}: {nobody}; start one with `dask scheduler`" in line
    assert f"; 0 of 1 points are done and kept in {tmp_path / 'o'}; go on: " in line
    assert line.endswith(f"--scheduler {nobody} --resume")


def leave(connection):
    pass


def say_nothing(connection):
    while connection.recv(10**6):
        pass


def say_back(connection):
    while heard := connection.recv(10**6):
        connection.sendall(heard)


def babble(connection):
    connection.sendall(random.Random(1).randbytes(10**5))


def speak_http(connection):
    connection.recv(10**6)
    connection.sendall(b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n")


@pytest.fixture
def stranger(request):
    """Address of a server that answers each connection in some way."""

    def serve():
        with suppress(OSError):  # of the closed server, or of one that has gone
            while True:
                with server.accept()[0] as connection, suppress(OSError):
                    request.param(connection)

    with socket.create_server(("127.0.0.1", 0)) as server:
        Thread(target=serve, daemon=True).start()
        yield "tcp://{}:{}".format(*server.getsockname())


@pytest.mark.parametrize(
    "stranger", [leave, say_nothing, say_back, babble, speak_http], indirect=True
)
def test_what_answers_but_is_no_scheduler_is_told_of_at_once(
    stranger, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr("sim.sweeps.worker_pool.ANSWER", 1.0)
    file = write_sweep(tmp_path, "[grid]\nfriction = [0.5]\n")
    words = ("sweep", file, "--out", tmp_path / "o", "--scheduler", stranger)
    began = time.monotonic()
    assert main(list(map(str, words))) == 8
    assert time.monotonic() - began < 20  # 1.5 s are waited; the machine may be busy
    (line,) = told(capsys.readouterr().err)
    assert line.startswith("stratawalk: error: no scheduler answers, ")
    assert f": {stranger}; start one with `dask scheduler`" in line
    assert line.endswith(f"--scheduler {stranger} --resume")


@pytest.fixture(scope="module")
def client():
    """Of one worker on this machine."""
    with warnings.catch_warnings():  # of a port that another scheduler has
        warnings.simplefilter("ignore")
        with open_pool(1, None) as pool:
            yield pool.client


def test_a_living_worker_is_not_taken_for_dead(monkeypatch, tmp_path, client):
    points = points_of(read_sweep(str(write_sweep(tmp_path, POISON))), Shard())
    pool = WorkerPool(client)
    # What the client's own poll leaves behind now and then.
    monkeypatch.setattr(client, "scheduler_info", lambda **_: {"workers": {}})
    found = [outcome.status for outcome in pool.carry_out(points.tasks(()))]
    assert found == ["ok"] * 3
    assert not pool.deaths


def test_workers_of_a_sweep_obey_nobody_else(client):
    """Any user of the machine reaches their ports, and could have them run code."""

    async def ask(address):
        async with rpc(address.replace("tls:", "tcp:"), timeout=2.0) as stranger:
            await stranger.identity()

    (one,) = client.cluster.workers.values()  # and who watches over it
    for address in (client.scheduler.address, one.address, one.worker_address):
        with pytest.raises(OSError, match="before comm was established"):
            asyncio.run(ask(address))


def test_what_a_worker_takes_with_it_is_done_again(monkeypatch, client):
    """It dies with a finished point that nobody has fetched yet, and once more."""
    (nanny,) = client.cluster.workers.values()
    fetch, killed = Future.result, []

    def killing(future, timeout=60.0):
        if len(killed) < 2 and nanny.pid not in (None, *killed):
            killed.append(nanny.pid)
            os.kill(nanny.pid, signal.SIGKILL)
        return fetch(future, timeout)

    monkeypatch.setattr(Future, "result", killing)
    pool = WorkerPool(client)
    found = [outcome.status for outcome in pool.carry_out([Task("a", {})])]
    assert len(killed) == 2
    assert found == ["name is missing: the sweep; give name"]


def test_a_worker_that_dies_as_it_starts_ends_the_sweep(tmp_path):
    (tmp_path / "sitecustomize.py").write_text("import os\nos._exit(1)\n")
    file, out = write_sweep(tmp_path, POISON), tmp_path / "out"
    words = ("sweep", file, "--out", out, "--workers", 1)
    done = stratawalk(*words, env=ENV | {"PYTHONPATH": str(tmp_path)})
    assert done.returncode == 8
    (line,) = told(done.stderr)
    assert "a worker died as it started: 1 here; " in line
