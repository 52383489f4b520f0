"""Real Dask schedulers and workers, as its own command line starts them."""

import os
import sys
import time
from contextlib import contextmanager
from importlib import import_module

import pandas

from tests.commands import FORKS
from tests.sweeps import ENV


@contextmanager
def running(kind, *words, env=ENV):
    """A process of Dask's own command line, for as long as the block runs."""
    process = FORKS.Process(target=dask, args=(kind, list(map(str, words)), env))
    process.start()
    try:
        yield process
    finally:
        process.terminate()
        process.join(60)


def dask(kind, words, env):
    """Be that command line; libraries are loaded anew where they are others there."""
    os.dup2(os.open(os.devnull, os.O_RDWR), 1)
    os.dup2(1, 2)
    module = f"distributed.cli.dask_{kind}"
    if env != ENV:
        os.execve(sys.executable, [sys.executable, "-m", module, *words], env)
    import_module(module).main(words)


@contextmanager
def cluster(folder, env=ENV, nanny="--no-nanny"):
    """Address of a real scheduler with a worker, both on loopback."""
    file = folder / "scheduler.json"
    host = ("--host", "127.0.0.1")
    named = ("--port", 0, "--no-dashboard", "--scheduler-file", file)
    with running("scheduler", *host, *named, env=env):
        began = time.monotonic()
        while not (file.exists() and file.stat().st_size):
            assert time.monotonic() - began < 120
            time.sleep(0.1)
        address = pandas.read_json(file, typ="series")["address"]
        with running(
            "worker", address, *host, "--nworkers", 1, "--nthreads", 1, nanny,
            "--no-dashboard", "--local-directory", folder / "scratch", env=env,
        ):  # fmt: skip
            yield address
