#!/usr/bin/env python3
"""Feed the command what nobody would write, and look how it ends.

Mutates scenarios, cards, MJCF, systems, saved plans and options, and runs the command
on each in this process: `python scripts/fuzz.py --seconds 180 --seed 1`. A case fails if
it ends with code 70, an exception, more than one line on standard error, a code that
is none of ours, or not within a minute. Models are tried here, not by a process of
their own, and shipped robots are loaded once, so that a case takes some hundredths of
a second. Failed cases are left in a folder, each with its files and command.
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
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import NoReturn

ROOT = Path(__file__).resolve().parents[1]
CODES = {0, 2, 3, 4, 6}
LIMIT = 60  # [s] a case may take
NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
NASTY = (
    *("nan", "inf", "-inf", "0", "-0.0", "-1", "1e308", "-1e308", "1e-320", "1e999"),
    *(
        "1e6",
        "0.5",
        "2",
        "7",
        "1e-9",
        "true",
        "''",
        '"x"',
        "[]",
        "{}",
        "[[]]",
        "[1, 2]",
    ),
    *(
        str(2**63),
        "9" * 400,
        "1" * 5000,
        "[" * 300,
        "\x00",
        "\udcff",
        "ö",
        "1979-05-27",
    ),
)
SYSTEM = """state = ["x", "y", "theta"]
goal = { y = 1 }
segments = 4
[parameters]
r = 0.5
[limits]
[strata.0]
roll = { x = "r*cos(theta)", y = "r*sin(theta)" }
turn = { theta = 1 }
"""
FORMULAS = ("Abs(x)", "sign(y)", "sqrt(x)", "1/x", "x**y", "log(x)", "atan2(y, x)")
OPTIONS = (
    *("--segments", "--fields", "--steer", "--robot", "--set", "--replan", "--json"),
    *("--goal", "--start", "--elements", "--flows", "--gait", "--at", "--depth"),
)
WORDS = (
    *(
        "line",
        "ellipse",
        "biped",
        "car",
        "hexapod",
        "quadruped",
        "lifted",
        "paper",
        "12",
    ),
    *(
        "quasi-static",
        "x=1",
        "y=nan",
        "=",
        "x=",
        "friction=0",
        "path.goal=[0,0,0]",
        "S1",
    ),
    *(
        "hold=1e-9",
        "path.kind=ellipse",
        "steer=1",
        "name=../x",
        "",
        "-1",
        "3",
        "1e9",
        ".",
    ),
)


class Hang(BaseException):
    """A case that takes too long."""


def mutated(text: str, rng: random.Random) -> str:
    """A text with one to four things changed."""
    for _ in range(rng.randint(1, 4)):
        text = rng.choice(MUTATIONS)(text, rng)
    return text


def _number(text: str, rng: random.Random) -> str:
    places = list(NUMBER.finditer(text))
    if not places:
        return text
    place = rng.choice(places)
    return text[: place.start()] + rng.choice(NASTY) + text[place.end() :]


def _word(text: str, rng: random.Random) -> str:
    words = list(re.finditer(r"[A-Za-z_]\w*", text)) or list(re.finditer(".", text))
    if len(words) < 2:
        return text
    old, new = rng.choice(words), rng.choice(words)[0]
    return text[: old.start()] + rng.choice((new, *FORMULAS)) + text[old.end() :]


def _lines(text: str, rng: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    if not lines:
        return text
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    match rng.randrange(3):
        case 0:
            del lines[at]
        case 1:
            lines.insert(other, lines[at])
        case _:
            lines[at], lines[other] = lines[other], lines[at]
    return "".join(lines)


def _cut(text: str, rng: random.Random) -> str:
    return text[: rng.randrange(len(text) + 1)] if rng.random() < 0.2 else text


MUTATIONS: tuple[Callable[[str, random.Random], str], ...] = (
    *(_number, _number, _number, _word, _lines, _cut),
)


@cache
def _read(*parts: str) -> str:
    return ROOT.joinpath(*parts).read_text()


def scenario(folder: Path, rng: random.Random) -> list[str]:
    """A mutated scenario, planned."""
    name = rng.choice(("line", "ellipse", "diagonal", "corridor"))
    text = "segments = 3\n" + re.sub(
        r"segments = \d+\n", "", _read("sim", "scenarios", f"{name}.toml")
    )
    _write(folder / "mine.toml", mutated(text, rng))
    return ["plan", "mine.toml"]


def card(folder: Path, rng: random.Random) -> list[str]:
    """A mutated card beside the shipped robot."""
    return _robot(folder, ("hexapod.toml",), rng)


def mjcf(folder: Path, rng: random.Random) -> list[str]:
    """A mutated model."""
    return _robot(folder, ("hexapod.xml",), rng)


def _robot(folder: Path, spoilt: tuple[str, ...], rng: random.Random) -> list[str]:
    for name in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        text = _read("models", "robots", name)
        text = mutated(text, rng) if name in spoilt else text
        _write(folder / name.replace("hexapod", "mine"), text)
    return [rng.choice(("robots", "check")), "mine.xml"]


def system(folder: Path, rng: random.Random) -> list[str]:
    """A mutated system."""
    _write(folder / "mine.toml", mutated(SYSTEM, rng))
    return [rng.choice(("check", "plan")), "mine.toml"]


@cache
def _plan() -> str:
    from models import load_system
    from planner import plan, save_plan

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "system.toml")
        path.write_text(SYSTEM)
        problem = load_system(path)
        made = plan(problem.system, problem.path, 2, ["roll", "turn", "[roll,turn]"])
        save_plan(made, path.with_suffix(".json"))
        return path.with_suffix(".json").read_text().replace(", ", ",\n")


def archive(folder: Path, rng: random.Random) -> list[str]:
    """A mutated plan that was saved."""
    _write(folder / "mine.json", mutated(_plan(), rng))
    return ["plan", "mine.json"]


def options(folder: Path, rng: random.Random) -> list[str]:
    """Words in any order."""
    count = rng.randint(0, 4)
    words = [rng.choice(OPTIONS + WORDS + WORDS) for _ in range(count)]
    return [rng.choice(("plan", "check", "robots", "scenarios")), *words]


KINDS = {k.__name__: k for k in (scenario, card, mjcf, system, archive, options)}


def _write(path: Path, text: str) -> None:
    path.write_bytes(text.encode("utf-8", errors="surrogateescape"))


def fault(words: list[str]) -> str | None:
    """What is wrong with how the command ends, or None."""
    from sim import cli

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
    lines = said.getvalue().splitlines()
    if time.monotonic() - began >= LIMIT:
        return f"takes {LIMIT} s"
    if code not in CODES:
        return f"ends with {code}: {' '.join(lines)[:300]}"
    if len(lines) > 1 or (len(lines) == 1) != (code != 0):
        return f"says {len(lines)} lines with code {code}: {lines[:2]}"
    return None


def quicken() -> None:
    """Load shipped robots once, and try models in this process."""
    from models import library
    from models.description import inspection, trial

    def tried(path: Path) -> list[str]:
        report = trial.report(path)
        if "files" not in report:
            raise inspection.ModelError(str(report.get("wrong", "too large")))
        return list(report["files"])  # type: ignore[call-overload]

    inspection._tried = tried
    signal.signal(signal.SIGALRM, _hang)
    library.parse_card = cache(library.parse_card)


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
    faults = 0
    quicken()
    end = time.monotonic() + asked.seconds
    for kind, seed in cases(asked.seed, asked.kinds):
        if time.monotonic() > end or done.total() >= asked.cases:
            break
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            words = KINDS[kind](Path(folder), random.Random(seed))
            wrong = fault(words)
            os.chdir(home)
            done[kind] += 1
            if wrong is not None:
                faults += 1
                print(f"{kind} {seed}: {json.dumps(words)[:200]}: {wrong}", flush=True)
                shutil.copytree(folder, keep / f"{kind}-{seed}", dirs_exist_ok=True)
    print(f"{done.total()} cases, {faults} faults: {dict(done)}")
    return int(faults > 0)


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    sys.exit(main())
