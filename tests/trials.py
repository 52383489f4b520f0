"""Models of strangers are tried in forks of one process that has loaded the engine.

They keep their limits; only the start of a process each is saved, which takes longer
than most models. Tests that ask for `alone` begin real ones, and so does every command
that a test runs with an environment or streams of its own.
"""

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from socketserver import ForkingMixIn, StreamRequestHandler, UnixStreamServer
from types import SimpleNamespace

from models.description import inspection


class Trial(StreamRequestHandler):
    """A line has a folder and the words for the trial; its output is the answer."""

    def handle(self):
        """Try it where the process is that asks."""
        folder, *words = json.loads(self.rfile.readline())
        os.chdir(folder)
        os.dup2(self.connection.fileno(), 1)
        inspection.main(*words)


class Trials(ForkingMixIn, UnixStreamServer):
    """It ends with the process that began it."""

    request_queue_size = 64

    def service_actions(self):
        """End, if that process is no more."""
        super().service_actions()
        if os.getppid() != self.owner:
            sys.exit()


@cache
def begin():
    """Begin the process of trials, which this process owns; its address."""
    path = str(Path(tempfile.mkdtemp(), "trials"))
    quick = {"MUJOCO_GL": "disabled", "OPENBLAS_NUM_THREADS": "1"}
    begun = subprocess.Popen(
        [sys.executable, "-m", "tests.trials", path],
        env=os.environ | quick | {"PYTHONPATH": str(inspection.ROOT)},
        cwd=inspection.ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    while not os.path.exists(path):
        assert begun.poll() is None
        time.sleep(0.02)
    BEGUN.append(begun)  # Python warns of processes that are forgotten
    return path


def _forked(command, **_):
    """What the process would print, from a fork."""
    words = command[command.index(inspection.__spec__.name) + 1 :]
    with socket.socket(socket.AF_UNIX) as trial:
        trial.connect(begin())
        trial.sendall(json.dumps([os.getcwd(), *words]).encode() + b"\n")
        trial.shutdown(socket.SHUT_WR)
        with trial.makefile("rb") as answer:
            return SimpleNamespace(returncode=0, stdout=answer.read())


BEGUN = []
FORKED = SimpleNamespace(**vars(subprocess) | {"run": _forked})


if __name__ == "__main__":
    (path,) = sys.argv[1:]
    try:
        with Trials(f"{path}.new", Trial) as trials:
            trials.owner = os.getppid()
            os.rename(f"{path}.new", path)
            trials.serve_forever()
    finally:
        shutil.rmtree(Path(path).parent)
