"""Inputs for `scripts/fuzz.py`: what is shipped, with one to four things changed.

Every kind is a function that writes its files into a folder and returns the words of
the command to run there.
"""

import json
import random
import re
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

from planner.support import shipped_tables
from scripts.endings import ROOT

TEXTS = shipped_tables("scripts", "fuzz.toml")
NASTY = (*TEXTS["nasty"], "9" * 400, "1" * 5000, "[" * 300, "\x00", "\udcff", "ö")


def mutated(text: str, rng: random.Random) -> str:
    """A text with one to four things changed, now and then cut off."""
    for _ in range(rng.randint(1, 4)):
        text = rng.choice(MUTATIONS)(text, rng)
    return text[: rng.randrange(len(text) + 1)] if rng.random() < 0.05 else text


def write(path: Path, text: str) -> None:
    """Write a text that need not be Unicode."""
    path.write_bytes(text.encode("utf-8", errors="surrogateescape"))


def _number(text: str, rng: random.Random) -> str:
    if not (places := list(re.finditer(r"-?\d+\.?\d*(?:e-?\d+)?", text))):
        return text
    place = rng.choice(places)
    return text[: place.start()] + rng.choice(NASTY) + text[place.end() :]


def _word(text: str, rng: random.Random) -> str:
    words = list(re.finditer(r"[A-Za-z_]\w*", text)) or list(re.finditer(".", text))
    if len(words) < 2:
        return text
    old, new = rng.choice(words), rng.choice(words)[0]
    new = rng.choice((new, *TEXTS["formulas"]))
    return text[: old.start()] + new + text[old.end() :]


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


Mutation = Callable[[str, random.Random], str]
MUTATIONS: tuple[Mutation, ...] = (_number, _number, _number, _word, _lines)


@cache
def _read(*parts: str) -> str:
    return ROOT.joinpath(*parts).read_text()


def scenario(folder: Path, rng: random.Random) -> list[str]:
    """A mutated scenario, planned."""
    name = rng.choice(("line", "ellipse", "diagonal", "corridor"))
    own = _read("sim", "scenarios", f"{name}.toml")
    write(folder / "mine.toml", mutated(f"plan_time = 0.5\n{own}", rng))
    return ["plan", "mine.toml"]


def robot(folder: Path, rng: random.Random, spoilt: str) -> list[str]:
    """A shipped robot, one of whose files is mutated."""
    for name in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        text = _read("models", "robots", name) + TEXTS["card"] * name.endswith(".toml")
        text = mutated(text, rng) if name == spoilt else text
        write(folder / name.replace("hexapod", "mine"), text)
    return [rng.choice(("robots", "check")), "mine.xml"]


def system(folder: Path, rng: random.Random) -> list[str]:
    """A mutated system."""
    write(folder / "mine.toml", mutated(TEXTS["system"], rng))
    return [rng.choice(("check", "plan")), "mine.toml"]


@cache
def _plan() -> str:
    from models import load_system
    from planner import plan, save_plan

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "system.toml")
        path.write_text(TEXTS["system"])
        problem = load_system(path)
        made = plan(problem.system, problem.path, 2, ["roll", "turn", "[roll,turn]"])
        save_plan(made, path.with_suffix(".json"))
        return json.dumps(json.loads(path.with_suffix(".json").read_text()), indent=0)


def archive(folder: Path, rng: random.Random) -> list[str]:
    """A mutated plan that was saved."""
    write(folder / "mine.json", mutated(_plan(), rng))
    return ["plan", "mine.json"]


def options(folder: Path, rng: random.Random) -> list[str]:
    """Words in any order."""
    words = rng.choices(TEXTS["options"] + 2 * TEXTS["words"], k=rng.randint(0, 4))
    return [rng.choice(("plan", "check", "robots", "scenarios")), *words]


OWN_KINDS: dict[str, Callable[[Path, random.Random], list[str]]] = {
    "scenario": scenario,
    "card": partial(robot, spoilt="hexapod.toml"),
    "mjcf": partial(robot, spoilt="hexapod.xml"),
    "system": system,
    "archive": archive,
    "options": options,
}
