"""Arrays of a run that are read, or computed, when they are asked for."""

from __future__ import annotations

import csv
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from models import ModelError
from planner import Array
from planner.support import open_file
from sim.errors import UsageError

UNREADABLE = (
    OSError, KeyError, ValueError, IndexError, EOFError, ModelError, zipfile.BadZipFile,
    zlib.error, csv.Error,
)  # fmt: skip


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


def archive(folder: Path, name: str) -> Arrays:
    """The arrays of one of a folder's files."""

    def load(key: str) -> Array:
        with reading(folder), open_file(folder / name) as file:
            array = np.load(file, allow_pickle=False)[key]
            if not isinstance(array, np.ndarray):
                raise ValueError(f"{key} is no array")
        return array

    with open_file(folder / name) as file, np.load(file, allow_pickle=False) as arrays:
        return Arrays(arrays.files, load)


@contextmanager
def reading(folder: Path) -> Iterator[None]:
    """Refuse a folder that cannot be read as that of a finished run."""
    remedy = "give the folder of a finished run"
    try:
        if not folder.is_dir():
            raise UsageError("no such run folder", str(folder), remedy)
        if not (folder / "scenario.toml").is_file():
            raise FileNotFoundError("it lacks scenario.toml")
        yield
    except UsageError:
        raise
    except UNREADABLE as error:
        reason = " ".join(str(error).split())
        what = f"not a finished run, {reason}"
        raise UsageError(what, str(folder), remedy) from error
