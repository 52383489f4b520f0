#!/usr/bin/env python3
"""Run the command on mutated inputs, and check how it ends.

Scenarios, cards, MJCF, systems, saved plans and options are mutated, and the command is
run on each of them in this process: `python -m scripts.fuzz --seconds 180 --seed 1`. A
case fails if the command ends with code 70, with an exception, with more than one line
on standard error, with an unknown code, or not within a minute. Models are compiled
here and not by a process of their own, so that a case takes some hundredths of a
second. Failed cases are kept in a folder, each with its files.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import random
import re
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from models import ModelError
from scripts.fuzz_inputs import KINDS

CODES = {0, 2, 3, 4, 6}
PROGRESS = re.compile(r"[a-z ]+ +\d+%")  # what long work says of itself
LIMIT = 60  # [s] a case may take


class Hang(BaseException):
    """A case that takes too long."""


def fault(words: list[str]) -> str | None:
    """What is wrong with how the command ends, or None."""
    cli = import_module("sim.cli")
    said, printed = io.StringIO(), io.StringIO()
    signal.setitimer(signal.ITIMER_REAL, LIMIT)
    began = time.monotonic()
    try:
        with (
            contextlib.redirect_stderr(said),
            contextlib.redirect_stdout(printed),
            warnings.catch_warnings(action="ignore"),
        ):
            code = cli.main(words)
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        return f"raises {type(error).__name__}: {error}"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    lines = [x for x in said.getvalue().splitlines() if not PROGRESS.match(x)]
    if time.monotonic() - began >= LIMIT:
        return f"takes {LIMIT} s"
    if code not in CODES:
        return f"ends with {code}: {' '.join(lines)[:300]}"
    if len(lines) > 1 or (len(lines) == 1) != (code != 0):
        return f"says {len(lines)} lines with code {code}: {lines[:2]}"
    return None


def quicken() -> None:
    """Try models in this process; no door leads to the part that is replaced."""
    inspection = import_module("models.description.inspection")
    trial = import_module("models.description.trial")

    def tried(path: Path) -> list[str]:
        report = trial.report(path)
        if "files" not in report:
            raise ModelError(str(report.get("wrong", "too large")))
        return list(report["files"])

    inspection._tried = tried  # type: ignore[attr-defined]
    signal.signal(signal.SIGALRM, _hang)


def _hang(number: int, frame: object) -> NoReturn:
    raise Hang


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
    parser.add_argument("--keep", default="fuzz-finds", help="folder for failed cases")
    asked = parser.parse_args()
    keep, home, done = Path(asked.keep).resolve(), Path.cwd(), Counter[str]()
    faults, longest = 0, dict[str, tuple[float, int]]()
    quicken()
    end = time.monotonic() + asked.seconds
    for kind, seed in cases(asked.seed, asked.kinds):
        if time.monotonic() > end or done.total() >= asked.cases:
            break
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            words = KINDS[kind](Path(folder), random.Random(seed))
            began = time.monotonic()
            wrong = fault(words)
            took = time.monotonic() - began
            os.chdir(home)
            done[kind] += 1
            longest[kind] = max(longest.get(kind, (0.0, 0)), (round(took, 1), seed))
            if wrong is not None:
                faults += 1
                print(f"{kind} {seed}: {json.dumps(words)[:200]}: {wrong}", flush=True)
                shutil.copytree(folder, keep / f"{kind}-{seed}", dirs_exist_ok=True)
    print(f"{done.total()} cases, {faults} faults: {dict(done)}")
    print(f"longest, in seconds, and their seeds: {longest}")
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
