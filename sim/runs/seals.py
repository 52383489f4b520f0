"""Seals of a run: digests by which files of one walk are known to belong together.

They hold no secret, so that they guard against mixtures and slips alone. Parts of
tables may change: servos may be mounted anew.
"""

import hashlib
import json
from collections.abc import Collection, Mapping
from os.path import normpath
from pathlib import Path
from typing import Any

from planner.support import open_file
from sim.scenarios.settings import SETTINGS

Table = Mapping[str, object]
Seals = dict[str, str | None]
CARD = "model.toml"  # beside model.xml, as a robot's card is
MAKE = "servo"  # which the card says of all of them
MODEL = "model.xml"  # whose seal waits until it was inspected
FREE = {k for k, s in SETTINGS.items() if s.affects <= {"label", "film", "refusal"}}
TOLD = ("seals", "timing")  # of summary.json; a film that is drawn takes time
MOUNTED = ("description", "servo", "board")  # of a card
TABLES = {"scenario.toml": FREE, CARD: MOUNTED, "summary.json": TOLD}
WHOLE = ("commands.npz", "trajectory.npz", "flows.csv", "feedback.csv")
LARGEST_SEALED = 4 * 10**9  # bytes of all files, which take seconds to digest


def seals(folder: Path, *tables: Table, copies: Collection[str] = ()) -> Seals:
    """Seals of a run's files, from what scenario, card and summary hold.

    Copies are the robot's files. A summary that has seals names its own ones, which are
    sealed again, all but the model.
    """
    sealed = told if isinstance(told := tables[-1].get("seals"), Mapping) else {}
    names = {*WHOLE, *map(str, sealed)} - {*TABLES, MODEL, MAKE} | {*copies}
    inside = [n for n in sorted(names) if n == normpath(n) and n[0] not in "./"]
    servos: Any = tables[1].get("servo", {})  # those of single joints are tables
    make = {key: value for key, value in servos.items() if not isinstance(value, dict)}
    named = zip(TABLES.items(), tables, strict=True)
    found: Seals = {name: _seal_of_table(table, free) for (name, free), table in named}
    found[MAKE] = _seal_of_table(make, ())
    for name in {CARD, MAKE} - (sealed or found).keys():  # as in earlier versions
        del found[name]
    room = LARGEST_SEALED
    for name in inside:
        found[name] = seal(folder / name, room)
        room -= (folder / name).stat().st_size if found[name] else 0
    return found


def seal(path: Path, most: int = LARGEST_SEALED) -> str | None:
    """Digest of a file; None if there is no such file, or it is too large."""
    if not path.is_file() or path.stat().st_size > most:
        return None
    digest, left = hashlib.sha256(), path.stat().st_size
    with open_file(path) as file:  # those of /proc have no size, and no end
        while left > 0 and (part := file.read(min(left, 10**6))):
            digest.update(part)
            left -= len(part)
    return digest.hexdigest()[:16]


def _seal_of_table(table: Table, without: Collection[str]) -> str:
    own = {key: value for key, value in table.items() if key not in without}
    plain = json.loads(json.dumps(own, default=str))  # as it is read
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()[:16]
