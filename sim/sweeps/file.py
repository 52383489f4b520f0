"""A sweep's file: which scenario, what is fixed, and what varies."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from planner.support import did_you_mean
from sim.errors import UsageError
from sim.scenarios.file import anchor, read_toml, scenario_from, scenario_table
from sim.scenarios.scenario import Scenario
from sim.sweeps.axes import (
    MOST_POINTS,
    Block,
    flat,
    grid_blocks,
    list_block,
    sobol_block,
)

STUDIES = Path(str(files("sim.studies")))
TABLES = ("set", "grid", "list", "sobol", "keep")
KEYS = ("scenario", "without", *TABLES)
MEASURES = ("identified", "compliant", "creep_floor")
"""What a sweep may leave out, since each costs physics of its own."""


@dataclass(frozen=True)
class Sweep:
    """What a sweep's file says."""

    name: str  # of the file
    scenario: Mapping[str, object]  # the scenario as a table of plain values
    fixed: Mapping[str, object]  # settings of every point, by their dotted names
    blocks: tuple[Block, ...]  # what varies
    without: tuple[str, ...]  # measures that are left out
    run_folders: tuple[int, ...] = ()  # numbers of the points that get a run folder
    filmed: bool = False  # whether these folders get films

    def __post_init__(self) -> None:
        if len(self) > MOST_POINTS:
            remedy = f"ask for {MOST_POINTS} at most"
            raise UsageError(f"{len(self)} points", f"sweep {self.name!r}", remedy)

    def __len__(self) -> int:
        return math.prod(len(choices) for _, choices in self.blocks)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys that vary, in the order of the file."""
        return tuple(key for keys, _ in self.blocks for key in keys)

    def varied(self, point: int) -> dict[str, object]:
        """Values of the varying keys at a point; the last block varies fastest."""
        values: dict[str, object] = {}
        for keys, choices in reversed(self.blocks):
            point, place = divmod(point, len(choices))
            values |= zip(keys, choices[place], strict=True)
        return {key: values[key] for key in self.keys}

    def at(self, point: int) -> Scenario:
        """The scenario of a point."""
        changes = {**self.fixed, **self.varied(point)}
        place = f"point {point} of sweep {self.name!r}"
        return scenario_from(self.scenario, changes, place)


def read_sweep(source: str) -> Sweep:
    """Read a sweep's file, or a shipped study by its name."""
    path = _find(source)
    table = read_toml(path)
    scenario = _scenario(table, path)
    fixed = dict(flat(_inner(table, "set")))
    _anchor_values(fixed, path.parent)
    blocks = tuple(_anchored(block, path.parent) for block in _blocks(table))
    given = Counter([*fixed, *(key for keys, _ in blocks for key in keys)])
    for key in (key for key, times in given.items() if times > 1):
        raise UsageError(f"{key} is given twice", source, "keep it in one table")
    count = math.prod(len(choices) for _, choices in blocks)
    without, kept = left_out(table.get("without", [])), _inner(table, "keep")
    return Sweep(
        path.stem, scenario, fixed, blocks, without, *_run_folders(kept, count)
    )


def shipped_studies() -> tuple[str, ...]:
    """Names of the sweeps that come with the package."""
    return tuple(sorted(path.stem for path in STUDIES.glob("*.toml")))


def _find(source: str) -> Path:
    if source in shipped_studies():
        return STUDIES / f"{source}.toml"
    path = Path(source)
    if path.is_file():
        return path
    if path.suffix or len(path.parts) > 1:
        raise UsageError("no such sweep file", source, "give a TOML file that exists")
    remedy = f"{did_you_mean(source, shipped_studies())}; or give a file"
    raise UsageError(f"unknown study {source!r}", "FILE.toml", remedy)


def _scenario(table: Mapping[str, object], path: Path) -> Mapping[str, object]:
    """The scenario that is named, or the one whose tables stand in the sweep's file."""
    named = table.get("scenario")
    own = {key: value for key, value in table.items() if key not in KEYS}
    remedy = 'give scenario = "line", say'
    if isinstance(named, Mapping):
        own, named = {**named, **own}, None
    if named is None:
        if "path" not in own:
            raise UsageError("no scenario is named", str(path), remedy)
        own = {"name": path.stem, **own}
        anchor(own, path.parent)
        return own
    for key in own:
        raise UsageError(f"unknown key {key!r}", str(path), did_you_mean(key, KEYS))
    if not isinstance(named, str):
        raise UsageError(f"scenario = {named!r} is no name", str(path), remedy)
    beside = path.parent / named
    return scenario_table(str(beside) if beside.is_file() else named)[0]


def _inner(table: Mapping[str, object], key: str) -> Mapping[str, object]:
    inner = table.get(key, {})
    if not isinstance(inner, Mapping):
        raise UsageError(f"{key} is no table", "the sweep's file", f"write [{key}]")
    return inner


def _blocks(table: Mapping[str, object]) -> Iterator[Block]:
    yield from grid_blocks(_inner(table, "grid"))
    if side_by_side := _inner(table, "list"):
        yield list_block(side_by_side)
    if samples := _inner(table, "sobol"):
        yield sobol_block(samples)


def _anchor_values(values: dict[str, object], folder: Path) -> None:
    anchor(values, folder)
    if isinstance(file := values.get("path.file"), str):
        values["path.file"] = str((folder / file).resolve())


def _anchored(block: Block, folder: Path) -> Block:
    """A block that names the files of robots so that they are found from anywhere."""
    keys, choices = block
    rows = [dict(zip(keys, choice, strict=True)) for choice in choices]
    for values in rows:
        _anchor_values(values, folder)
    return keys, [tuple(values[key] for key in keys) for values in rows]


def left_out(given: object) -> tuple[str, ...]:
    """The measures that a sweep leaves out, in order."""
    if not isinstance(given, list) or not all(word in MEASURES for word in given):
        what = f"without = {given!r} is not allowed"
        names = " and ".join(MEASURES)
        raise UsageError(what, "the sweep's file", f"give a list of {names}")
    return tuple(sorted(given))


def _run_folders(
    table: Mapping[str, object], count: int
) -> tuple[tuple[int, ...], bool]:
    points, filmed = table.get("points", []), table.get("film", False)
    for key in table.keys() - {"points", "film"}:
        near = did_you_mean(key, ("points", "film"))
        raise UsageError(f"unknown key {key!r}", "[keep]", near)
    numbers = points if isinstance(points, list) else [None]
    if not all(type(point) is int and 0 <= point < count for point in numbers):
        remedy = f"give a list of whole numbers from 0 to {count - 1}"
        raise UsageError(f"points = {points!r} is not allowed", "[keep]", remedy)
    if not isinstance(filmed, bool):
        raise UsageError(f"film = {filmed!r}", "[keep]", "give true or false")
    return tuple(sorted(set(numbers))), filmed
