"""Values that a sweep goes through: lists, ranges and Sobol samples.

A block is a list of choices; a choice gives values to one or several keys. The points
of a sweep are all combinations of the choices of its blocks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from sim.errors import UsageError
from sim.scenarios.declaration import is_number
from sim.scenarios.settings import SETTINGS

Choice = tuple[object, ...]  # values of the block's keys
Block = tuple[tuple[str, ...], Sequence[Choice]]  # keys, and their choices
RANGE = {"from", "to", "count", "scale"}
LINEAR, LOGARITHMIC = "linear", "log"
MOST_POINTS = 1_000_000  # of a sweep
WHOLE = {name for name, item in SETTINGS.items() if item.includes(int)}


def grid_blocks(table: Mapping[str, object]) -> Iterator[Block]:
    """A block for each key, so that all combinations are gone through."""
    for key, given in flat(table):
        yield (key,), [(value,) for value in _values(key, given, "[grid]")]


def list_block(table: Mapping[str, object]) -> Block:
    """One block, in which the lists of all keys go side by side."""
    columns = {key: _values(key, given, "[list]") for key, given in flat(table)}
    lengths = {key: len(values) for key, values in columns.items()}
    if len(set(lengths.values())) > 1:
        counts = ", ".join(f"{key} has {count}" for key, count in lengths.items())
        remedy = "give all of them as many values, or put them under [grid]"
        raise UsageError(f"lists of different lengths, {counts}", "[list]", remedy)
    return tuple(columns), list(zip(*columns.values(), strict=True))


def sobol_block(table: Mapping[str, object]) -> Block:
    """One block of a scrambled Sobol sequence between lowest and highest values.

    The table has the number of `points`, a `seed`, and for each key its `[low, high]`.
    """
    from scipy.stats import qmc

    count = _whole("points", table.get("points"), 1, MOST_POINTS)
    seed = _whole("seed", table.get("seed", 0), 0, 2**32 - 1)
    spans = dict(flat({k: v for k, v in table.items() if k not in ("points", "seed")}))
    if not spans:
        raise UsageError("no key varies", "[sobol]", "give a key = [low, high]")
    engine = qmc.Sobol(len(spans), scramble=True, rng=np.random.default_rng(seed))
    unit = engine.random_base2(math.ceil(math.log2(count)))[:count]
    columns = [
        _stretch(part, *_span(given, f"[sobol] {key}"), key in WHOLE)
        for part, (key, given) in zip(unit.T, spans.items(), strict=True)
    ]
    return tuple(spans), list(zip(*columns, strict=True))


def flat(table: Mapping[str, object], head: str = "") -> Iterator[tuple[str, object]]:
    """Keys of a table and of the tables in it, as `path.goal`, with their values.

    Ranges, and tables that say what kind of thing they are, count as values.
    """
    for key, value in table.items():
        if isinstance(value, Mapping) and not _is_value(value):
            yield from flat(value, f"{head}{key}.")
        else:
            yield f"{head}{key}", value


def _is_value(table: Mapping[str, object]) -> bool:
    return "kind" in table or {"from", "to"} <= table.keys()


def _values(key: str, given: object, block: str) -> list[object]:
    if isinstance(given, list) and given:
        return list(given)
    where = f"{block} {key}"
    if not isinstance(given, Mapping) or not given.keys() <= RANGE:
        remedy = "give [a, b, ...] or { from = a, to = b, count = n }"
        raise UsageError("neither a list nor a range", where, remedy)
    count = _whole(f"{where}: count", given.get("count"), 1, MOST_POINTS)
    parts = np.linspace(0.0, 1.0, count)
    return _stretch(parts, *_span(given, where), key in WHOLE)


def _span(given: object, where: str) -> tuple[float, float, str]:
    """Both ends and the scale."""
    ends, scale = given, LINEAR
    if isinstance(given, Mapping):
        ends, scale = [given.get("from"), given.get("to")], given.get("scale", LINEAR)
    two = isinstance(ends, list) and len(ends) == 2 and all(map(is_number, ends))
    if not isinstance(ends, list) or not two or not all(map(math.isfinite, ends)):
        raise UsageError("no two ends", where, "give [low, high], two numbers")
    low, high = ends
    if scale not in (LINEAR, LOGARITHMIC) or (scale == LOGARITHMIC and low <= 0):
        what = f"scale = {scale!r} from {low} to {high} is not allowed"
        remedy = 'give scale = "linear", or "log" between two ends above 0'
        raise UsageError(what, where, remedy)
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
