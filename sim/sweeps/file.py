"""A sweep's file: which scenario, what is fixed, and what varies.

What varies are lists, ranges and Sobol samples. A block is a list of choices; a choice
gives values to one or several keys. The points of a sweep are all combinations of the
choices of its blocks.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from planner.support import did_you_mean
from sim.errors import UsageError
from sim.scenarios import file as scenarios
from sim.scenarios.declaration import is_number, require_keys
from sim.scenarios.predictions import COSTLY
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import SETTINGS

Choice = tuple[object, ...]  # values of the block's keys
Block = tuple[tuple[str, ...], Sequence[Choice]]  # keys, and their choices
Table = Mapping[str, object]
RANGE = {"from", "to", "count", "scale"}
LINEAR, LOGARITHMIC = "linear", "log"
LAST_END = 1e100  # between ends beyond it there may be no numbers
OF_SOBOL = {"points", "seed"}  # which are no settings there
MOST_POINTS = 50_000  # of a sweep; checking them takes some ten seconds
MOST_KEYS = 100  # of a sweep; of so many points they take half a gigabyte
WHOLE = {name for name, item in SETTINGS.items() if item.includes(int)}
STUDIES = Path(str(files("sim.studies")))
TABLES = ("set", "grid", "list", "sobol", "keep")
KEYS = ("scenario", "without", *TABLES)


@dataclass(frozen=True)
class Sweep:
    """What a sweep's file says."""

    name: str  # of the file
    scenario: Table  # the scenario as a table of plain values
    fixed: Table  # settings of every point, by their dotted names
    blocks: tuple[Block, ...]  # what varies
    without: tuple[str, ...]  # measures that are left out
    run_folders: tuple[int, ...] = ()  # numbers of the points that get a run folder
    filmed: bool = False  # whether these folders get films

    def __post_init__(self) -> None:
        if not 0 < (count := _count(self.blocks)) <= MOST_POINTS:
            where = f"sweep {self.name!r}"
            raise UsageError.of("points", where, count=count, most=MOST_POINTS)

    def __len__(self) -> int:
        return _count(self.blocks)

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
        place = f"point {point} of sweep {self.name!r}"
        return scenarios.scenario_from(
            self.scenario, {**self.fixed, **self.varied(point)}, place
        )


def read_sweep(source: str) -> Sweep:
    """Read a sweep's file, or a shipped study by its name."""
    path = scenarios.find(source, STUDIES, "sweep", "FILE.toml", "give a file")
    table = scenarios.read_toml(path)
    scenario = _scenario(table, path)
    fixed = dict(flat(_inner(table, "set")))
    scenarios.anchor(fixed, path.parent)
    tables = (_inner(table, name) for name in ("set", "grid", "list", "sobol"))
    times = Counter(key for inner in tables for key, _ in flat(inner))
    times.subtract(_inner(table, "sobol").keys() & OF_SOBOL)
    for key in (key for key, count in times.items() if count > 1):
        raise UsageError(f"{key} is given twice", source, "keep it in one table")
    if (count := len(+times)) > MOST_KEYS:
        raise UsageError.of("keys", source, count=count, most=MOST_KEYS)
    made = list[Block]()
    for block in grid_blocks(_inner(table, "grid")):
        made.append(block)
        if _count(made) > MOST_POINTS**2:  # of which no more are counted
            break
    made += [list_block(lists)] if (lists := dict(flat(_inner(table, "list")))) else []
    made += [sobol_block(inner)] if (inner := _inner(table, "sobol")) else []
    blocks = tuple(_anchored(block, path.parent) for block in made)
    if isinstance(named := table.get("scenario"), str):
        scenarios.tell_of_run(path.parent / named, times)
    keep = _run_folders(_inner(table, "keep"), _count(blocks))
    without = left_out(table.get("without", []))
    return Sweep(path.stem, scenario, fixed, blocks, without, *keep)


def _count(blocks: Sequence[Block]) -> int:
    return math.prod(len(choices) for _, choices in blocks)


def shipped_studies() -> tuple[str, ...]:
    """Names of the sweeps that come with the package."""
    return tuple(sorted(path.stem for path in STUDIES.glob("*.toml")))


def _scenario(table: Table, path: Path) -> Table:
    """The scenario that is named, or the one whose tables stand in the sweep's file."""
    named = table.get("scenario")
    own = {key: value for key, value in table.items() if key not in KEYS}
    remedy = 'give scenario = "line", say'
    if isinstance(named, Mapping):
        own, named = {**named, **own}, None
    if named is None:
        if not {"path", "motion"} & own.keys():
            raise UsageError("no scenario is named", str(path), remedy)
        own = {"name": path.stem, **own}
        scenarios.anchor(own, path.parent)
        return own
    for key in own:
        if key in SETTINGS:
            raise UsageError.of("in_no_table", path, key=key)
        raise UsageError(f"unknown key {key!r}", str(path), did_you_mean(key, KEYS))
    if not isinstance(named, str):
        raise UsageError(f"scenario = {named!r} is no name", str(path), remedy)
    at = (path.parent / named).absolute()  # names that are shipped have no dot or slash
    return scenarios.scenario_table(
        str(at) if {*"./"} & {*named} and at.is_file() else named
    )[0]


def _inner(table: Table, key: str) -> Table:
    inner = table.get(key, {})
    if not isinstance(inner, Mapping):
        raise UsageError(f"{key} is no table", "the sweep's file", f"write [{key}]")
    return inner


def _anchored(block: Block, folder: Path) -> Block:
    """A block that names the files of robots so that they are found from anywhere."""
    keys, choices = block
    rows = [dict(zip(keys, choice, strict=True)) for choice in choices]
    for values in rows:
        scenarios.anchor(values, folder)
    return keys, [tuple(values.values()) for values in rows]


def left_out(given: object) -> tuple[str, ...]:
    """The measures that a sweep leaves out, in order."""
    if not isinstance(given, list) or not all(word in COSTLY for word in given):
        facts = {"given": given, "names": " and ".join(COSTLY)}
        raise UsageError.of("without", "the sweep's file", **facts)
    return tuple(sorted(set(given)))


def _run_folders(table: Table, count: int) -> tuple[tuple[int, ...], bool]:
    points, filmed = table.get("points", []), table.get("film", False)
    require_keys(table, "[keep]", (), ("points", "film"))
    numbers = points if isinstance(points, list) else [None]
    if not all(type(point) is int and 0 <= point < count for point in numbers):
        raise UsageError.of("kept", "[keep]", points=points, last=count - 1)
    if not isinstance(filmed, bool):
        raise UsageError(f"film = {filmed!r}", "[keep]", "give true or false")
    return tuple(sorted(set(numbers))), filmed


def grid_blocks(table: Table) -> Iterator[Block]:
    """A block for each key, so that all combinations are gone through."""
    for key, given in flat(table):
        yield (key,), [(value,) for value in _values(key, given, "[grid]")]


def list_block(table: Table) -> Block:
    """One block, in which the lists of all keys go side by side."""
    columns = {key: _values(key, given, "[list]") for key, given in flat(table)}
    lengths = {key: len(values) for key, values in columns.items()}
    if len(set(lengths.values())) > 1:
        counts = ", ".join(f"{key} has {count}" for key, count in lengths.items())
        raise UsageError.of("lengths", "[list]", counts=counts)
    return tuple(columns), list(zip(*columns.values(), strict=True))


def sobol_block(table: Table) -> Block:
    """One block of a scrambled Sobol sequence between lowest and highest values.

    The table has the number of `points`, a `seed`, and for each key its `[low, high]`.
    """
    from scipy.stats import qmc

    count = _whole("points", table.get("points"), 1, MOST_POINTS)
    seed = _whole("seed", table.get("seed", 0), 0, 2**32 - 1)
    spans = dict(flat({k: v for k, v in table.items() if k not in OF_SOBOL}))
    if not spans:
        raise UsageError.of("keys", "[sobol]", count="no", most=MOST_KEYS)
    engine = qmc.Sobol(len(spans), scramble=True, rng=np.random.default_rng(seed))
    unit = engine.random_base2(math.ceil(math.log2(count)))[:count]
    columns = [
        _stretch(part, *_span(given, f"[sobol] {key}"), key in WHOLE)
        for part, (key, given) in zip(unit.T, spans.items(), strict=True)
    ]
    return tuple(spans), list(zip(*columns, strict=True))


def flat(table: Table, head: str = "") -> Iterator[tuple[str, object]]:
    """Keys of a table and of the tables in it, as `path.goal`, with their values.

    Ranges, and tables that say what kind of thing they are, count as values.
    """
    for key, value in table.items():
        if len(head) + len(key) > 200:  # letters
            raise UsageError.of("long_key", "the sweep's file", key=f"{head}{key}"[:40])
        if isinstance(value, Mapping) and not (
            "kind" in value or {"from", "to"} <= value.keys()
        ):
            yield from flat(value, f"{head}{key}.")
        else:
            yield f"{head}{key}", value


def _values(key: str, given: object, block: str) -> list[object]:
    if isinstance(given, list) and given:
        return list(given)
    where = f"{block} {key}"
    if not isinstance(given, Mapping) or not given.keys() <= RANGE:
        raise UsageError.of("no_values", where)
    count = _whole(f"{where}: count", given.get("count"), 1, MOST_POINTS)
    return _stretch(np.linspace(0.0, 1.0, count), *_span(given, where), key in WHOLE)


def _span(given: Any, where: str) -> tuple[float, float, str]:
    """Both ends and the scale."""
    ends, scale = given, LINEAR
    if isinstance(given, Mapping):
        ends, scale = [given.get("from"), given.get("to")], given.get("scale", LINEAR)
    near = isinstance(ends, list) and [is_number(e) and abs(e) < LAST_END for e in ends]
    if near != [True, True]:
        raise UsageError.of("two_ends", where, far=LAST_END)
    low, high = ends
    tight = scale == LOGARITHMIC and min(ends) <= 1 / LAST_END
    if scale not in (LINEAR, LOGARITHMIC) or tight:
        facts = {"scale": scale, "low": low, "high": high, "least": 1 / LAST_END}
        raise UsageError.of("scale", where, **facts)
    return low, high, scale


def _stretch(
    unit: np.ndarray, low: float, high: float, scale: str, whole: bool
) -> list[object]:
    """Numbers from 0 to 1 stretched between two ends; rounded if whole ones are due."""
    straight = scale == LINEAR
    values = low + unit * (high - low) if straight else low * (high / low) ** unit
    return [round(value) if whole else float(f"{value:.12g}") for value in values]


def _whole(what: str, value: object, low: int, high: int) -> int:
    if not isinstance(value, bool) and isinstance(value, int) and low <= value <= high:
        return value
    remedy = f"give a whole number from {low} to {high}"
    raise UsageError(f"{what} = {value!r} is not allowed", "the sweep's file", remedy)
