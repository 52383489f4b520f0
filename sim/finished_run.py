"""The folder of a finished run, as everything that reads one finds it."""

from __future__ import annotations

import csv
import zipfile
import zlib
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from models import ModelError
from planner import Array
from planner.support import open_file, read_file
from sim.errors import UsageError
from sim.scenarios.body_path import NominalPath

REMEDY = "give the folder of a finished run"
NOMINAL_POINTS = 400  # of the nominal path as it is drawn
UNREADABLE = (
    OSError, KeyError, ValueError, IndexError, EOFError, ModelError, zipfile.BadZipFile,
    zlib.error, csv.Error,
)  # fmt: skip


@contextmanager
def reading(folder: Path, otherwise: str, remedy: str = REMEDY) -> Iterator[None]:
    """Say of a folder that cannot be read that it is no finished run.

    Args:
        folder: Which one.
        otherwise: What is said of it before the reason.
        remedy: What to do.

    Raises:
        UsageError: If the block ends with an error of a file or what is in it.
    """
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
        raise UsageError(f"{otherwise}, {reason}", str(folder), remedy) from error


def arrays_of(
    folder: Path,
    name: str,
    keys: Collection[str] | None = None,
    without: Collection[str] = (),
) -> dict[str, Array]:
    """Arrays of one of its files; those that are not there are left out.

    Args:
        folder: Of the run.
        name: `trajectory.npz` or `commands.npz`.
        keys: Names of the arrays; all if not given.
        without: Names of arrays that are not even decompressed.
    """
    with open_file(folder / name) as file, np.load(file, allow_pickle=False) as arrays:
        asked = arrays.files if keys is None else keys
        return {k: arrays[k] for k in arrays if k in asked and k not in without}


def phases_of(folder: Path) -> list[dict[str, str]]:
    """Lines of flows.csv, by the names of its columns.

    Raises:
        ValueError: If a line has more or fewer entries than there are columns.
    """
    text = read_file(folder / "flows.csv").decode()
    lines = [line for line in csv.reader(text.splitlines()) if line]
    if len({len(line) for line in lines}) != 1:
        raise ValueError("flows.csv is incomplete")
    return [dict(zip(lines[0], line, strict=True)) for line in lines[1:]]


def nominal_poses(path: NominalPath) -> Array:
    """The nominal path as it is drawn, shape (N, 3)."""
    return np.array([path(s) for s in np.linspace(0, 1, NOMINAL_POINTS)])
