"""The real command in a process of its own, as tests run it."""

import errno
import os
import re
import subprocess
import sys
import tempfile
from multiprocessing import get_context
from pathlib import Path
from subprocess import PIPE

from sim import start
from sim.pictures import gl

COMMAND = [sys.executable, "-m", "sim.cli"]
OUTSIDE = {
    key: value
    for key, value in os.environ.items()
    if key != gl.ASKED and not key.startswith("PYTHON")
} | {"PYTHONPATH": os.getcwd()}
"""The tests' surroundings without what changes Python or the driver of pictures."""

FORKS = get_context("forkserver")
FORKS.set_forkserver_preload(["tests.commands", "tests.warm"])


def run(words, folder, stdout=PIPE, stderr=PIPE, **environment):
    """Run the command in a folder, in a process of its own.

    It is forked from one that has loaded all libraries, which takes longer than most
    commands, unless its streams or environment are not the usual ones.
    """
    words = [str(word) for word in words]
    if (stdout, stderr, environment) != (PIPE, PIPE, {}):
        return subprocess.run(
            [*COMMAND, *words],
            cwd=folder,
            env=OUTSIDE | environment,
            stdout=stdout,
            stderr=stderr,
            text=True,
        )
    begun = Begun(words, folder)
    texts = begun.communicate()
    return subprocess.CompletedProcess(words, begun.returncode, *texts)


class Begun:
    """The command in a fork of a process that has loaded all libraries; as `Popen`."""

    def __init__(self, words, folder, environment=OUTSIDE):
        self._outputs = tempfile.TemporaryDirectory()
        self._paths = [Path(self._outputs.name, name) for name in ("stdout", "stderr")]
        given = [str(word) for word in words], folder, environment, *self._paths
        self._process = FORKS.Process(target=_run, args=given)
        self._process.start()
        self.pid = self._process.pid

    @property
    def returncode(self):
        """Its exit code; None while it runs."""
        return self._process.exitcode

    def poll(self):
        """The same."""
        return self._process.exitcode

    def send_signal(self, number):
        """Send it a signal."""
        os.kill(self.pid, number)

    def communicate(self, timeout=None):
        """What it has printed until its end, and its messages."""
        self._process.join(timeout)
        assert self.returncode is not None
        with self._outputs:
            return [path.read_text() for path in self._paths]


def _run(words, folder, environment, *paths):
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    for number, path in enumerate(paths, start=1):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT), number)
    sys.argv = ["stratawalk", *words]
    sys.exit(start.main())


PROGRESS = re.compile(r"[^:]+, (about \d+ s left|\d+ s so far)")


def told(stderr):
    """Lines on standard error but those that say how far it is, on a slow machine."""
    return [line for line in stderr.splitlines() if not PROGRESS.fullmatch(line)]


def refusal(done):
    """The one line that a refused command prints, without its head."""
    assert not done.stdout
    (line,) = told(done.stderr)
    head, _, rest = line.partition("stratawalk: error: ")
    assert head == ""
    return rest


def forbidden(*words):
    """Run the command as one to whom permissions apply, whoever runs the tests."""
    bound = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"]
    prefix = bound * (os.geteuid() == 0)
    given = [*prefix, sys.executable, "-m", "sim.start", *map(str, words)]
    return subprocess.run(given, capture_output=True, text=True, check=False)


def full_disk(*_, **__):
    """In place of what writes a file."""
    raise OSError(errno.ENOSPC, "No space left on device")
