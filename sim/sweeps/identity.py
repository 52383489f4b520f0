"""What a point is: its settings, the files of its robot and motion, as a short digest.

The versions of the software stand beside it. A point is done once and for all if its
digest is known; whether results of other versions may stand in one table is for the
user to say.
"""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path

from models import ModelError, load
from sim.scenarios.file import to_table
from sim.scenarios.scenario import Scenario
from sim.sweeps.file import flat
from sim.versions import versions

CODE = ("planner", "models", "sim")
KINDS = (".py", ".toml", ".xml")


def digest(scenario: Scenario, without: Sequence[str]) -> str:
    """Digest of everything that decides the numbers of a point, but for versions.

    Names and descriptions of scenarios do not matter.
    """
    named = to_table(scenario).items()
    table = {key: value for key, value in named if key not in ("name", "description")}
    own = ((path, path.stat()) for path in _own_files(scenario))
    used = [(str(path), _digest(path, at.st_mtime_ns, at.st_size)) for path, at in own]
    content = json.dumps([table, sorted(without), used], sort_keys=True, default=str)
    return hashlib.sha256(content.encode()).hexdigest()[:32]


def software() -> dict[str, str]:
    """Versions that numbers depend on, the machine's architecture, our own code."""
    return versions() | {"machine": platform.machine(), "code": _code()}


def differences(first: Mapping[str, object], second: Mapping[str, object]) -> list[str]:
    """What two tables disagree on by dotted names, as `key: value, now value`."""
    one, other = dict(flat(first)), dict(flat(second))
    keys = [*one, *(key for key in other if key not in one)]
    return [
        f"{key}: {_shown(one, key)}, now {_shown(other, key)}"
        for key in keys
        if one.get(key) != other.get(key)
    ]


def _shown(table: Mapping[str, object], key: str) -> str:
    text = json.dumps(table[key]) if key in table else "nothing"
    return text if len(text) <= 80 else f"{text[:38]} ... {text[-38:]}"


@cache
def _code() -> str:
    """Digest of this package's own sources; as git's hash, but for what is changed."""
    parts = hashlib.sha256()
    for package in CODE:
        for path in sorted(Path(str(files(package))).rglob("*")):
            if path.suffix in KINDS:
                parts.update(path.name.encode() + path.read_bytes())
    return parts.hexdigest()[:16]


def _own_files(scenario: Scenario) -> list[Path]:
    """Motion, card and all that the model of a user's robot opens; none if shipped."""
    own = {Path(scenario.motion)} if scenario.motion else set[Path]()
    path = Path(scenario.robot)
    if path.suffix == ".xml" and path.is_file():
        own |= {path.with_suffix(".toml"), *_opened(str(path), path.stat().st_mtime_ns)}
    return sorted(path for path in own if path.is_file())


@cache
def _opened(robot: str, changed: int) -> frozenset[Path]:
    try:
        return frozenset(load(robot).opened.files)
    except ModelError:  # the reason stands in the table, for each of its points
        return frozenset({Path(robot)})


@cache
def _digest(path: Path, changed: int, size: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
