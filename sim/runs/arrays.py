"""Arrays of a run that are read, or computed, when they are asked for."""

import csv
import json
import os
import zipfile
import zlib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from glob import escape
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from models import ModelError
from planner import Array
from planner.support import open_file
from sim.endings import command
from sim.errors import UsageError
from sim.scenarios.file import shipped_scenarios

UNREADABLE = (
    OSError, KeyError, ValueError, IndexError, EOFError, ModelError, zipfile.BadZipFile,
    zlib.error, csv.Error, RuntimeError,
)  # fmt: skip
UNPACKED = 5 * 10**8  # of the arrays of a file, packed or not
MOST_ARRAYS = 100
LARGEST = 1e9  # number; what is drawn from larger ones overflows
HEADERS = {
    1: np.lib.format.read_array_header_1_0,
    2: np.lib.format.read_array_header_2_0,
}
SINGLE = ("time", "phase", "margin", "clearance", "height", "roll", "pitch")
OF_FEET = ("contact", "slip", "load")
ROWS = {**dict.fromkeys(SINGLE, ()), **dict.fromkeys(OF_FEET, (0,)),
        "point": (0, 2), "pose": (3,), "mass": (3,)}  # fmt: skip
"""Shapes of rows by the last word of an array's name; 0 is the number of feet."""


class Arrays(Mapping[str, Array]):
    """Named arrays, each of them computed or read whenever it is asked for."""

    def __init__(self, names: Iterable[str], load: Callable[[str], Array]) -> None:
        self._names, self._load = tuple(names), load

    def __getitem__(self, name: str) -> Array:
        if name not in self._names:
            raise KeyError(name)
        return self._load(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def archive(
    folder: Path, name: str, feet: int, apart: Collection[str], check: bool
) -> Arrays:
    """The arrays of one of a folder's files, a row a moment but for those `apart`.

    What the file declares is compared with what it holds, with what may be read, and
    with what a robot with so many feet has, before any of it is read. Arrays have
    finite numbers; all are read once for a `check`.
    """

    def load(key: str) -> Array:
        with reading(folder), open_file(folder / name) as file:
            array = np.load(file, allow_pickle=False)[key]
            numbers = array[array != -np.inf] if key.endswith("margin") else array
            if not ((numbers > -LARGEST) & (numbers < LARGEST)).all():
                raise ValueError(f"{key} of {name} is not finite or beyond {LARGEST:g}")
        return array

    with open_file(folder / name) as file:
        if os.fstat(file.fileno()).st_size > UNPACKED:
            raise ValueError(f"{name} is larger than {UNPACKED / 1e9:g} GB")
        with zipfile.ZipFile(file) as archive:
            shapes = dict(_declared(archive, name))
    rows = {shape[:1] for key, shape in shapes.items() if key not in apart}
    if len(rows) > 1 or () in rows or (0,) in rows:
        raise ValueError(f"the arrays of {name} have different numbers of rows")
    for key in shapes.keys() - apart:
        row = ROWS.get(key.rpartition("_")[2], shapes[key][1:])
        if shapes[key][1:] != (wanted := tuple(n or feet for n in row)):
            got = f"rows of {key} of {name} have the shape {shapes[key][1:]}"
            raise ValueError(f"{got} instead of {wanted}")
    for key in shapes if check else ():
        load(key)
    return Arrays(shapes, load)


def _declared(
    archive: zipfile.ZipFile, name: str
) -> Iterator[tuple[str, tuple[int, ...]]]:
    """Names and shapes of arrays, once they are found to be as large as declared."""
    members = archive.infolist()
    total = sum(member.file_size for member in members)
    if len(members) > MOST_ARRAYS or total > UNPACKED:
        declared = f"{name} declares {len(members)} arrays of {total / 1e9:.3g} GB"
        most = f"{MOST_ARRAYS} of {UNPACKED / 1e9:g} GB are the most"
        raise ValueError(f"{declared}, and {most}")
    for member in members:
        key = member.filename.removesuffix(".npy")
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{key} of {name} is packed in an unknown way")
        with archive.open(member) as file:
            version, _ = np.lib.format.read_magic(file)
            shape, _, dtype = HEADERS[version](file)
            size = file.tell() + prod(shape) * dtype.itemsize
        kinds = ("b1",) if key.endswith("contact") else ("i8", "f8")  # none grows
        if dtype.str[1:] not in kinds:
            raise ValueError(f"{key} of {name} has {dtype} in place of {kinds[-1]}")
        if size != member.file_size:
            declared = f"{key} of {name} declares {size} bytes of numbers"
            raise ValueError(f"{declared} and has {member.file_size}")
        yield key, shape


def plain_json(text: bytes) -> dict[str, Any]:
    """A table of JSON, in which no number is too large to be drawn."""

    def number(text: str) -> float:
        if abs(value := float(text)) < LARGEST:
            return value
        raise ValueError(f"{text} is not a number below {LARGEST:g}")

    try:
        table = json.loads(text, parse_float=number, parse_constant=number)
    except json.JSONDecodeError as error:
        raise ValueError(f"summary.json is no JSON, line {error.lineno}") from error
    if not isinstance(table, dict):
        raise ValueError("summary.json holds no table")
    return table


@contextmanager
def reading(folder: Path) -> Iterator[None]:
    """Refuse a folder that cannot be read as that of a finished run."""
    remedy = "give the folder of a finished run, as stratawalk run line makes"
    try:
        if not folder.is_dir():
            named = sorted(Path("runs").glob(f"{escape(folder.name)}*"))
            if folder.name in shipped_scenarios():
                remedy = f"walk it first: stratawalk run {folder.name}"
            if (folder.parent / "summary.json").is_file():
                remedy = f"give its folder, {folder.parent}"
            elif named:
                remedy = f"did you mean {named[-1]}?"
            raise UsageError("no such run folder", str(folder), remedy)
        if lacks := {"scenario.toml", "summary.json"}.difference(os.listdir(folder)):
            if any(folder.glob("sweep*.json")):
                remedy = f"{command('study', folder)} tells what it says"
                raise UsageError("a sweep and no run", str(folder), remedy)
            raise FileNotFoundError(f"it lacks {min(lacks)}")
        yield
    except (UsageError, PermissionError):
        raise
    except UNREADABLE as error:
        why: object = f"it lacks {error}" if isinstance(error, KeyError) else error
        if isinstance(error, zipfile.BadZipFile | zlib.error):
            why = "its arrays, trajectory.npz or commands.npz, are damaged"
        why = getattr(error, "strerror", None) or why
        place = getattr(error, "filename", None) or folder
        what = f"not a finished run, {' '.join(str(why).split())}"
        raise UsageError(what, str(place), remedy) from error
