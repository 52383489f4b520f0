#!/usr/bin/env python3
"""Run the command on mutated inputs, and check how it ends.

Scenarios, cards, MJCF, systems, saved plans and options are mutated, and the command is
run on each of them: `python -m scripts.fuzz --seconds 180 --seed 1`. A case fails if
the command ends with code 70, with an exception, with more than one line on standard
error, with an unknown code, or not within a minute; `--patience` gives it longer on a
busy machine, though no longer a time on the processor.

The cases run in a process beside this one (`scripts/fuzz_worker.py`), which is ended
and replaced where it does not answer in time or does not survive. What seems wrong
there is run once more, by the real command in a process of its own, and that decides.
Failed cases are kept in a folder, each with its files.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from scripts.fuzz_inputs import KINDS, ROOT
from scripts.fuzz_worker import judged, limit_process, serve

LIMIT = 60.0  # [s] a case may take, on the processor in any case
START = 100.0  # [s] a process may take to begin
SLICE = 0.5  # [s] of waiting; a stop of all processes counts as one
FRESH = 1000  # cases after which libraries have kept enough for another process


class Worker:
    """One process that runs cases, and the next one where it fails."""

    def __init__(self, limit: float = LIMIT, patience: float | None = None) -> None:
        """Begin without a process.

        Args:
            limit: Seconds of the processor that a case may take.
            patience: Seconds that it may take; as many if left out.
        """
        self._limit, self._patience = limit, patience or limit
        self._process: multiprocessing.process.BaseProcess | None = None
        self._left = 0

    def fault(self, words: list[str], folder: str) -> str | None:
        """What is wrong with how the command ends, or None.

        Args:
            words: Of the command line.
            folder: Where it is run.
        """
        seems = self.answer(words, folder)
        if seems is None:
            return None
        wrong = decided(words, folder, self._limit, self._patience)
        return wrong and f"{wrong} (first: {seems})"

    def answer(self, words: list[str], folder: str) -> str | None:
        """What seems wrong where one case is run after another, or None.

        Args:
            words: Of the command line.
            folder: Where it is run.
        """
        if self._process is None or not self._left:
            self._begin()
        self._left -= 1
        answer: str | None
        try:
            self._cases.send((folder, words))
            if self._comes(self._patience):
                answer = self._cases.recv()
                return answer
            answer = f"does not answer in {self._patience:g} s"
        except (EOFError, OSError):
            answer = "does not survive it"
        self.end()
        return answer

    def _begin(self) -> None:
        self.end()
        spawn = multiprocessing.get_context("spawn")
        self._cases, theirs = spawn.Pipe()
        self._process = spawn.Process(
            target=serve, args=(theirs, self._limit), daemon=True
        )
        self._process.start()
        theirs.close()
        if not self._comes(START + self._patience) or not self._cases.recv():
            raise RuntimeError("the process that runs the cases did not begin")
        self._left = FRESH

    def _comes(self, seconds: float) -> bool:
        return any(self._cases.poll(SLICE) for _ in range(math.ceil(seconds / SLICE)))

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()

    def end(self) -> None:
        """End the process and all that it started."""
        if self._process is not None:
            _end(self._process.pid)
            self._process.kill()
            self._process.join()
            self._cases.close()
        self._process = None


def decided(
    words: list[str], folder: str, limit: float = LIMIT, patience: float = LIMIT
) -> str | None:
    """What is wrong with how the real command ends, or None.

    Args:
        words: Of the command line.
        folder: Where it is run.
        limit: Seconds of the processor that it may take.
        patience: Seconds that it may take.
    """
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "sim.cli", *words],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,
            preexec_fn=lambda: limit_process(limit),
        )
        try:
            code = _ended(process, patience)
        finally:
            _end(process.pid)
            process.wait()
        said.seek(0)
        if code in (None, -signal.SIGXCPU):
            return f"takes {limit:g} s"
        return judged(process.returncode, said.read().decode(errors="replace"))


def _ended(process: subprocess.Popen[bytes], seconds: float) -> int | None:
    """The code with which a process ends in this time, or None."""
    for _ in range(math.ceil(seconds / SLICE)):
        with suppress(subprocess.TimeoutExpired):
            return process.wait(SLICE)
    return None


def _end(leader: int | None) -> None:
    """End all processes of a session, if it has begun and there are any left."""
    with suppress(ProcessLookupError):
        if leader:
            os.killpg(leader, signal.SIGKILL)


def cases(seed: int, kinds: list[str]) -> Iterator[tuple[str, int]]:
    """Kinds and seeds of cases without end."""
    rng = random.Random(seed)
    while True:
        yield rng.choice(kinds), rng.randrange(2**32)


def main() -> int:
    """Run cases until time or number is up; 1 if one fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=180.0)
    parser.add_argument("--cases", type=int, default=10**9)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--patience", type=float, default=LIMIT, help="[s] for a case")
    parser.add_argument("--keep", default="fuzz-finds", help="folder for failed cases")
    asked = parser.parse_args()
    with Worker(patience=asked.patience) as worker:
        return _run(asked, worker)


def _run(asked: argparse.Namespace, worker: Worker) -> int:
    keep, done = Path(asked.keep).resolve(), Counter[str]()
    faults, longest = 0, dict[str, tuple[float, int]]()
    end = time.monotonic() + asked.seconds
    for kind, seed in cases(asked.seed, asked.kinds):
        if time.monotonic() > end or done.total() >= asked.cases:
            break
        with tempfile.TemporaryDirectory() as folder:
            words = KINDS[kind](Path(folder), random.Random(seed))
            began = time.monotonic()
            wrong = worker.fault(words, folder)
            took = time.monotonic() - began
            done[kind] += 1
            longest[kind] = max(longest.get(kind, (0.0, 0)), (round(took, 1), seed))
            if done.total() % 1000 == 0:
                print(f"{done.total()} cases so far", flush=True)
            if wrong is not None:
                faults += 1
                print(f"{kind} {seed}: {json.dumps(words)[:200]}: {wrong}", flush=True)
                shutil.copytree(folder, keep / f"{kind}-{seed}", dirs_exist_ok=True)
    print(f"{done.total()} cases, {faults} faults: {dict(done)}")
    print(f"longest, in seconds, and their seeds: {longest}")
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
