"""Poses from a CSV file."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from planner.support import read_file

COLUMNS = ("x", "y", "yaw")  # [m], [m], [rad]
MOST_POSES = 100_000
LARGEST = 10**8  # bytes


def read_poses(path: Path) -> list[tuple[float, ...]]:
    """Poses from a CSV file with a column for each of `COLUMNS`, in any order.

    Args:
        path: The file, in UTF-8; its first line names the columns.

    Raises:
        ValueError: A column is missing or named twice, or a value is no number.
        OSError: It cannot be read.
    """
    try:
        return _read(path)
    except csv.Error as error:
        raise ValueError(
            f"no table, {error}; give a line of three numbers a pose"
        ) from None
    except UnicodeDecodeError:
        raise ValueError("is no text in UTF-8; save the table as such") from None


def _read(path: Path) -> list[tuple[float, ...]]:
    text = read_file(path, LARGEST).decode("utf-8-sig")  # spreadsheets mark it
    rows = csv.DictReader(io.StringIO(text, newline=""))
    names = [name.strip() for name in rows.fieldnames or ()]
    if missing := [name for name in COLUMNS if name not in names]:
        raise ValueError(f"no column {missing[0]!r}; begin with the line x,y,yaw")
    if twice := [name for name in COLUMNS if names.count(name) > 1]:
        raise ValueError(f"two columns {twice[0]!r}; name one of them otherwise")
    rows.fieldnames = names
    poses = []
    for number, row in enumerate(rows, start=2):
        try:
            poses.append(tuple(float(row[name]) for name in COLUMNS))
        except (TypeError, ValueError):
            raise ValueError(f"line {number} holds no pose; give numbers") from None
        if len(poses) > MOST_POSES:
            raise ValueError(f"more than {MOST_POSES} poses; leave some of them out")
    return poses
