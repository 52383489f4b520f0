#!/usr/bin/env python3
"""Run the command on mutated inputs, and check how it ends.

Scenarios, cards, MJCF, systems, saved plans and options are mutated, and so is what
others send: robots to adopt and their meshes, sweeps, their ledgers and tables, tables
of servos, finished runs, and what a browser says to the viewer. The command is run on
each of them: `python -m scripts.fuzz --seconds 180 --seed 1`. A case fails if the
command ends with code 70, with an exception, with more than one line on standard error,
with an unknown code, or not within a minute; within 10 s and 2 GB for what others send,
but 35 s to adopt. `--patience` gives it longer on a busy machine, but no longer on the
processor.

The cases run one after another in a process beside this one, whose memory and time are
limited, and which is ended and replaced where it does not answer in time or does not
survive. It compiles models itself and not in a process of their own, so that a case
takes some hundredths of a second. What seems wrong there is run once more, by the real
command in a process of its own, and that decides. Failed cases are kept in a folder,
each with its files.
"""

from __future__ import annotations

import contextlib
import functools
import io
import json
import math
import multiprocessing
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path

from models import ModelError
from scripts.endings import (
    ROOT,
    SLICE,
    Bounds,
    end_session,
    ending,
    judged,
    limit_process,
    lines_of,
)
from scripts.fuzz_foreign import FOREIGN
from scripts.fuzz_inputs import OWN_KINDS
from scripts.pages import parser_of

OWN = Bounds()  # of cases that we make ourselves, and of those that others send:
THEIRS = Bounds(10.0, 2 * 10**9)
ADOPTED = replace(THEIRS, seconds=35.0)  # the command gives itself 30 s
LOADING = 4.0  # [s] on the processor that the real command takes to begin
START = 100.0  # [s] a process may take to begin
KINDS = OWN_KINDS | FOREIGN
FRESH = 1000  # cases after which libraries have kept enough for another process


class Worker(contextlib.AbstractContextManager["Worker"]):
    """One process that runs cases, and the next one where it fails."""

    def __init__(self, patience: float = OWN.seconds) -> None:
        """Let a case take so long in all [s], whatever the machine does beside."""
        self.patience = patience
        self._process: multiprocessing.process.BaseProcess | None = None
        self._left = 0

    def fault(self, words: list[str], folder: str, bounds: Bounds = OWN) -> str | None:
        """What is wrong with how the command ends in a folder, or None."""
        if (seems := self.answer(words, folder, bounds)) is None:
            return None
        wrong = decided(words, folder, bounds, self.patience)
        return wrong and f"{wrong} (first: {seems})"

    def answer(self, words: list[str], folder: str, bounds: Bounds = OWN) -> str | None:
        """What seems wrong where one case is run after another, or None."""
        if self._process is None or not self._left:
            self._begin()
        self._left -= 1
        try:
            self._cases.send((folder, words, bounds))
            if self._comes(self.patience):
                found: str | None = self._cases.recv()
                return found
            answer = f"does not answer in {self.patience:g} s"
        except (EOFError, OSError):
            answer = "does not survive it"
        self.end()
        return answer

    def _begin(self) -> None:
        self.end()
        spawn = multiprocessing.get_context("spawn")
        self._cases, theirs = spawn.Pipe()
        self._process = spawn.Process(target=serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()
        if not self._comes(START + self.patience) or not self._cases.recv():
            raise RuntimeError("the process that runs the cases did not begin")
        self._left = FRESH

    def _comes(self, seconds: float) -> bool:
        return any(self._cases.poll(SLICE) for _ in range(math.ceil(seconds / SLICE)))

    def __exit__(self, *error: object) -> None:
        self.end()

    def end(self) -> None:
        """End the process and all that it started."""
        if self._process is not None:
            end_session(self._process.pid)
            self._process.kill()
            self._process.join()
            self._cases.close()
        self._process = None


def decided(
    words: list[str],
    folder: str,
    bounds: Bounds = OWN,
    patience: float = OWN.seconds,
) -> str | None:
    """What is wrong with how the real command ends, or None.

    It may take what the bounds say besides loading, and `patience` seconds in all.
    """
    bounds = replace(bounds, seconds=bounds.seconds + LOADING)
    command = [sys.executable, "-m", "sim.cli", *words]
    env = os.environ | {"PYTHONPATH": str(ROOT)}
    end = ending(command, folder, patience, env, partial(limit_process, bounds))
    if end.code in (None, -signal.SIGXCPU):
        return f"takes {bounds.seconds:g} s, or {patience:g} s in all"
    return judged(end.code, end.warned)


def serve(cases: Connection) -> None:
    """Answer a folder and the words of a command to run there with what is wrong.

    It goes on until the other end closes, or a case has computed to its bounds.
    """
    os.setsid()
    quicken()
    cases.send("ready")
    with tempfile.TemporaryFile() as below, contextlib.suppress(EOFError):
        for stream in (sys.stdout, sys.stderr):
            os.dup2(below.fileno(), stream.fileno())
        while True:
            folder, words, bounds = cases.recv()
            limit_process(bounds)
            os.chdir(folder)
            begin = below.seek(0, io.SEEK_END)
            wrong = fault(words)
            below.seek(begin)
            lines = below.read().decode(errors="replace").splitlines()
            cases.send(wrong or (f"a library says: {lines[:2]}" if lines else None))
            os.chdir("/")


def quicken() -> None:
    """Try models in this process, and make the parser of the command line once.

    No door leads to the parts that are replaced.
    """
    cli = import_module("sim.cli")
    cli.parser = functools.cache(cli.parser)  # type: ignore[attr-defined]
    inspection = import_module("models.description.inspection")
    trial = import_module("models.description.trial")

    def tried(path: Path, limits: object) -> list[str]:
        report = trial.report(path)
        if "files" not in report:
            raise ModelError(str(report.get("wrong", "too large")))
        return list(report["files"])

    inspection._tried = tried  # type: ignore[attr-defined]


def fault(words: list[str]) -> str | None:
    """What is wrong with how the command ends in this process, or None."""
    warned = io.StringIO()
    try:
        with (
            contextlib.redirect_stderr(warned),
            contextlib.redirect_stdout(io.StringIO()),
            warnings.catch_warnings(action="ignore"),  # as the command does
        ):
            code = import_module("sim.cli").main(words)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return f"raises {type(error).__name__}: {error}"
    return judged(code, lines_of(warned.getvalue()))


@dataclass
class Found:
    """What a search came to: cases of each kind, and how many of them are faults."""

    done: Counter[str] = field(default_factory=Counter)
    faults: int = 0
    longest: dict[str, tuple[float, int]] = field(default_factory=dict)  # [s], seeds


def search(
    worker: Worker,
    kinds: Sequence[str],
    rng: random.Random,
    seconds: float,
    cases: float,
    keep: Path,
) -> Found:
    """Run cases of some kinds until time or number is up, and keep those that fail."""
    found, end = Found(), time.monotonic() + seconds
    while time.monotonic() <= end and found.done.total() < cases:
        kind, seed = rng.choice(kinds), rng.randrange(2**32)
        with tempfile.TemporaryDirectory() as folder:
            began = time.monotonic()
            theirs = ADOPTED if kind.startswith("adopt") else THEIRS
            bounds = theirs if kind in FOREIGN else OWN
            try:
                words = KINDS[kind](Path(folder), random.Random(seed))
            except Exception as error:  # of what is tried in this process
                words = f"raises {type(error).__name__}: {error}"
            known = isinstance(words, str)
            wrong = words or None if known else worker.fault(words, folder, bounds)
            took = round(time.monotonic() - began, 1)
            if wrong is not None:
                found.faults += 1
                shown = json.dumps(words)[:200]
                print(f"{kind} {seed}: {shown}: {wrong}", flush=True)
                shutil.copytree(folder, keep / f"{kind}-{seed}", dirs_exist_ok=True)
        found.done[kind] += 1
        found.longest[kind] = max(found.longest.get(kind, (0.0, 0)), (took, seed))
        if found.done.total() % 1000 == 0:
            print(f"{found.done.total()} cases so far", flush=True)
    return found


def main() -> int:
    """Run cases until time or number is up; 1 if one fails."""
    parser = parser_of(__doc__)
    parser.add_argument("--seconds", type=float, default=180.0)
    parser.add_argument("--cases", type=int, default=10**9)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--patience", type=float, default=OWN.seconds, help="[s]")
    parser.add_argument("--keep", default="fuzz-finds", help="folder for failed cases")
    asked = parser.parse_args()
    with Worker(patience=asked.patience) as worker:
        found = search(
            worker,
            asked.kinds,
            random.Random(asked.seed),
            asked.seconds,
            asked.cases,
            Path(asked.keep).resolve(),
        )
    print(f"{found.done.total()} cases, {found.faults} faults: {dict(found.done)}")
    print(f"longest, in seconds, and their seeds: {found.longest}")
    return int(found.faults > 0)


if __name__ == "__main__":
    sys.exit(main())
