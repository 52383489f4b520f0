#!/usr/bin/env python3
"""Run the command on mutated inputs, and check how it ends.

Whatever the command receives is mutated: `python -m scripts.fuzz --seconds 180`, or
some kinds alone. A case fails that ends with code 70 or an unknown one, an exception,
or several lines on standard error, or takes more than `Bounds` allow. It has a process
forked from this one, which has loaded libraries; what seems wrong there is run once
more by the real command, and that decides. Failed cases are kept with their files.
"""

import gc
import json
import os
import random
import shutil
import sys
import tempfile
import time
from collections import Counter
from dataclasses import replace
from importlib import import_module
from pathlib import Path

from models import ModelError
from scripts.endings import ROOT, Bounds, ending, other
from scripts.fuzz_foreign import FOREIGN
from scripts.fuzz_inputs import OWN_KINDS, TEXTS
from scripts.pages import parser_of

OWN = Bounds()
LONG = {"adopt", "sensitivities"}  # up to 30 s, and 9 s for a sound walk
LOADING = 4.0  # [s] on the processor that the real command takes to begin
KINDS = OWN_KINDS | FOREIGN


def fault(words: list[str], folder: str | Path, bounds: Bounds = OWN) -> str | None:
    """What is wrong with how the command ends in a folder, or None."""
    seems = answer(words, folder, bounds)
    wrong = seems and decided(words, folder, bounds)
    return wrong and f"{wrong} (first: {seems})"


def answer(words: list[str], folder: str | Path, bounds: Bounds = OWN) -> str | None:
    """What seems wrong where a process forked from this one is the command."""

    def command() -> int:
        bounds.hold()
        inspection = import_module("models.description.inspection")
        inspection._tried = _tried  # type: ignore[attr-defined]  # no door leads there
        return int(import_module("sim.cli").main(words))

    return ending(command, folder, bounds.patience).wrong


def _tried(path: Path) -> list[str]:
    """The files that a model opens, compiled in this process."""
    report = import_module("models.description.inspection").report(path)
    if "files" not in report:
        raise ModelError(str(report.get("wrong", "too large")))
    return list(report["files"])


def decided(words: list[str], folder: str | Path, bounds: Bounds = OWN) -> str | None:
    """What is wrong with how the real command ends, or None; it may load besides."""

    def command() -> int:
        replace(bounds, seconds=bounds.seconds + LOADING).hold()
        env = os.environ | {"PYTHONPATH": str(ROOT)}
        return other([sys.executable, "-m", "sim.cli", *words], env)

    return ending(command, folder, bounds.patience).wrong


def tried(kind: str, seed: int, patience: float, keep: Path) -> bool:
    """Whether a case ends as it must; one that does not is told, and its files kept."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            words = KINDS[kind](Path(folder), random.Random(seed))
        except Exception as error:  # of what is tried in this process
            words = f"raises {type(error).__name__}: {error}"
        most = 35.0 if LONG & {*words[:1]} else OWN.seconds
        bounds = replace(OWN, seconds=most, patience=patience * most / OWN.seconds)
        wrong = words if isinstance(words, str) else fault(words, folder, bounds)
        if wrong:
            print(f"{kind} {seed}: {json.dumps(words)[:200]}: {wrong}", flush=True)
            shutil.copytree(folder, keep / f"{kind}-{seed}", dirs_exist_ok=True)
    return not wrong


def load() -> None:
    """Load and build what every case needs, so that processes share it."""
    import_module("sim.pictures.gl").choose()
    for name in TEXTS["loaded"]:
        import_module(name)
    cli = import_module("sim.cli")
    built = cli.parser()
    cli.parser = lambda: built  # type: ignore[attr-defined]
    gc.freeze()


def main() -> int:
    """Run cases until time or number is up; 1 if one fails."""
    parser = parser_of(__doc__)
    parser.add_argument("--seconds", type=float, default=180.0)
    parser.add_argument("--cases", type=int, default=10**9)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--patience", type=float, default=OWN.patience, help="[s]")
    parser.add_argument("--keep", default="fuzz-finds", help="folder for failed cases")
    asked = parser.parse_args()
    load()
    rng, keep = random.Random(asked.seed), Path(asked.keep).resolve()
    done, faults, end = Counter[str](), 0, time.monotonic() + asked.seconds
    longest: dict[str, tuple[float, int]] = {}  # [s], seeds
    while (began := time.monotonic()) <= end and done.total() < asked.cases:
        kind, seed = rng.choice(asked.kinds), rng.randrange(2**32)
        faults += not tried(kind, seed, asked.patience, keep)
        took = round(time.monotonic() - began, 1)
        longest[kind] = max(longest.get(kind, (0.0, 0)), (took, seed))
        done[kind] += 1
        if done.total() % 1000 == 0:
            print(f"{done.total()} cases so far", flush=True)
    print(f"{done.total()} cases, {faults} faults: {dict(done)}")
    print(f"longest, in seconds, and their seeds: {longest}")
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
