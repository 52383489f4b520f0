"""How a setting is declared: the kind of its values, its meaning, what it affects.

A kind is a type, such as `bool`, `Literal["ideal", "own"]`, `tuple[float, ...]` or a
union of these, in which numbers are `Annotated` with a `Range` and text may be with a
`Text`. The tables of paths and of obstacles hold values of kinds, too.
"""

import reprlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from math import isfinite
from numbers import Real
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeGuard, Union, get_args, get_origin

from models.description import is_plain
from planner.support import did_you_mean
from sim.errors import UsageError

Table = Mapping[str, Any]  # as TOML has it

LEAST = 1e-9  # of what must be above 0: what is divided by less overflows
Effect = Literal[
    "label", "equations", "plan", "motion", "world", "drive", "refusal", "known",
    "rows", "film",
]  # fmt: skip
"""What a setting can change: names, a robot's equations, the flows of a plan, the time
that phases take, the physics, the commands of servos, what is refused, what the
compliant prediction knows, the rows that are written, the film."""


@dataclass(frozen=True, slots=True)
class Range:
    """Limits of a number."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Text:
    """Text that may be empty, or is the name of a file; plain `str` is any but none."""

    empty: bool = False
    file_name: bool = False


@dataclass(frozen=True, slots=True)
class Setting:
    """What is declared about a setting."""

    name: str
    kind: object  # type of its values, with their limits
    default: object  # None leaves it to the robot or the run
    meaning: str
    unit: str
    affects: frozenset[Effect]
    imperfection: bool  # whether plans and predictions know nothing of it
    formerly: str  # name that it had before

    @property
    def about(self) -> str:
        """Meaning and unit."""
        what, semicolon, remark = self.meaning.partition(";")
        return f"{what} [{self.unit}]{semicolon}{remark}" if self.unit else self.meaning

    @property
    def allowed(self) -> str:
        """Values that it may have, with their unit, to follow the word "give"."""
        return f"{words(self.kind)} [{self.unit}]" if self.unit else words(self.kind)

    def includes(self, form: object) -> bool:
        """Whether values may be of a type, such as `int`, `tuple`, or `Literal`."""
        kinds = options(self.kind)
        return any(getattr(kind, "__origin__", kind) is form for kind in kinds)


def setting(
    meaning: str,
    default: object,
    affects: Effect | tuple[Effect, ...],
    unit: str = "",
    *,
    imperfection: bool = False,
    formerly: str = "",
) -> Any:
    """A field of `Settings`; for the arguments see `Setting`."""
    declared = {
        "meaning": meaning,
        "unit": unit,
        "affects": frozenset(affects if isinstance(affects, tuple) else (affects,)),
        "imperfection": imperfection,
        "formerly": formerly,
    }
    return field(default=default, metadata=declared)


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a real number; true and false are not."""
    return isinstance(value, Real) and not isinstance(value, bool)


def options(kind: object) -> tuple[object, ...]:
    """The types of a union, or the one type that there is."""
    return get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)


def read(value: object, kind: object) -> object:
    """The value as one of the types that a setting may have, else a `ValueError`."""
    *others, last = options(kind)
    for option in others:
        with suppress(ValueError):
            return _read_as(value, option)
    return _read_as(value, last)


def accept(value: object, kind: object, wanted: str, where: str, what: str = "") -> Any:
    """The value as one of a kind, or a refusal that says what is wanted instead."""
    try:
        return read(value, kind)
    except ValueError:
        raise refusal(value, wanted, where, what) from None


def refusal(value: object, wanted: str, where: str, what: str = "") -> UsageError:
    """An error for a value that is not allowed, whose key stands before it if given.

    The place ends with the key otherwise; what is wanted follows the word "give".
    """
    key = f"{what} = " if what else ""
    shown = f"{key}{reprlib.repr(value)} is not allowed"
    return UsageError(shown, where, f"give {wanted}")


def is_list(value: object) -> TypeGuard[Sequence[Any]]:
    """Whether a value is a list; text is none."""
    return isinstance(value, Sequence) and not isinstance(value, str)


def require_kind(table: object, where: str, kinds: Collection[str]) -> Table:
    """The table, once its `kind` is found to be a known one."""
    if not isinstance(table, Mapping) or not isinstance(table.get("kind"), str):
        raise refusal(table, f"a table whose kind is one of {', '.join(kinds)}", where)
    if table["kind"] not in kinds:
        what = f"unknown kind {table['kind']!r}"
        raise UsageError(what, where, did_you_mean(table["kind"], kinds))
    return table


def require_keys(
    table: Table, where: str, needed: Iterable[str], allowed: Iterable[str] = ()
) -> None:
    """Refuse a table with an unknown key or without a needed one, as `goal = [...]`."""
    examples = {example.partition(" ")[0]: example for example in needed}
    known = (*examples, *allowed)
    for key in [key for key in table if key not in ("kind", *known)]:
        raise UsageError(f"unknown key {key!r}", where, did_you_mean(key, known))
    for key in [key for key in examples if key not in table]:
        raise UsageError(f"{key} is missing", where, f"give {examples[key]}")


def _read_as(value: object, kind: object) -> object:
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        base, limits = inner
        return _number(value, base, limits) if base is not str else _text(value, limits)
    if origin is tuple and isinstance(value, list | tuple) and 0 < len(value) < 10**5:
        each = inner[:1] * len(value) if inner[-1] is Ellipsis else inner
        return tuple(read(v, k) for v, k in zip(value, each, strict=True))
    if origin is Mapping and isinstance(value, Mapping):
        return _table(value)
    if kind is str:
        return _text(value, Text())
    if origin is Literal and isinstance(value, str):
        spelt = [name.replace("_", "-") for name in inner]  # both spellings are taken
        return inner[spelt.index(value.replace("_", "-"))]
    if kind in (bool, NoneType) and isinstance(value, kind):
        return value
    raise ValueError


def _table(value: Mapping[str, object]) -> dict[str, float]:
    numbers = {str(key): v for key, v in sorted(value.items()) if is_number(v)}
    if len(numbers) < len(value) or not all(map(isfinite, numbers.values())):
        raise ValueError
    return {key: float(number) for key, number in numbers.items()}


def _number(value: object, base: type, limits: Range) -> float:
    if not is_number(value) or not limits.low <= value <= limits.high:
        raise ValueError
    number: float = base(value) + 0  # -0.0 is 0.0
    if number != value:
        raise ValueError
    return number


def _text(value: object, limits: Text) -> str:
    if not isinstance(value, str) or not (value or limits.empty):
        raise ValueError
    if limits.file_name and ("/" in value or value[0] in ".-" or not is_plain(value)):
        raise ValueError
    return value


@cache
def words(kind: object) -> str:
    """For example `a number from 0 to 0.02`."""
    kinds = [option for option in options(kind) if option is not NoneType]
    if len(kinds) > 1:
        return ", or ".join(map(words, kinds))
    origin, inner = get_origin(kinds[0]), get_args(kinds[0])
    if origin is Literal:
        return " or ".join(filter(None, (", ".join(inner[:-1]), inner[-1])))
    if origin is tuple and inner[0] is str:
        return "a list of names in quotation marks"
    if origin is tuple and get_origin(inner[0]) is Literal:
        return f"a list of {words(inner[0])}"
    if origin is tuple:
        each = [words(n).removeprefix("a number ") for n in inner if n is not Ellipsis]
        count = f"{len(each)} numbers:" if len(each) == len(inner) else "numbers"
        listed = ", ".join(each).replace(", or a number ", " or ")
        return f"a list of {count} {listed}"
    if origin is Annotated and isinstance(inner[1], Range):
        if inner[1].low == inner[1].high:
            return f"{inner[1].low:g}"
        noun = "a whole number" if inner[0] is int else "a number"
        return f"{noun} from {inner[1].low:.10g} to {inner[1].high:.10g}"
    if origin is Annotated and inner[1].file_name:
        return "text in quotation marks, without slashes and a first dash or dot"
    if origin is Mapping:
        return "numbers by name, { NAME = 0.5 }"
    return "true or false" if kinds[0] is bool else "text in quotation marks"
