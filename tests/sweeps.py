"""Small sweeps for tests: walks of a few seconds, run as the command runs them."""

import os
import subprocess
import sys
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from unittest import mock

from scripts.torture import TEXTS
from sim.cli import main
from sim.pictures import gl
from tests import commands

ENV = {k: v for k, v in os.environ.items() if k != gl.ASKED}
ENV["PYTHONPATH"] = str(Path(__file__).parents[1])


def write_sweep(folder, varies, name="small"):
    """A sweep's file that differs from the base in what varies."""
    path = folder / f"{name}.toml"
    path.write_text(TEXTS["sweep"] + varies)
    return path


def command(*words):
    """The words that start the command in a process of its own."""
    return [sys.executable, "-m", "sim.cli", *map(str, words)]


def stratawalk(*words, env=ENV):
    """Run the command; its result with its messages. Its workers begin anew."""
    begun = commands.Begun(words, os.getcwd(), env)
    texts = begun.communicate(300)
    return subprocess.CompletedProcess(words, begun.returncode, *texts)


class Here:
    """Walks points in this process, where it does not matter who walks them."""

    def carry_out(self, tasks):
        """The outcomes of tasks, one after another."""
        return (task.carry_out() for task in tasks)


@contextmanager
def _here(workers, scheduler):
    yield Here()


def walked_here(*words):
    """Run the command in this process, as its own and only worker."""
    words = [str(word) for word in words]
    with (
        mock.patch("sim.sweeps.sweeping.open_pool", _here),
        redirect_stdout(StringIO()) as out,
        redirect_stderr(StringIO()) as err,
    ):
        code = main(words)
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())


def poisoned(folder):
    """An environment in which a point of friction 0.666 kills its worker."""
    (folder / "sitecustomize.py").write_text(TEXTS["deadly"])
    path = os.pathsep.join([str(folder), ENV["PYTHONPATH"]])
    return ENV | {"PYTHONPATH": path}
