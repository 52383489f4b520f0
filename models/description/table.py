"""TOML read and written, and typed values from its tables, for cards and systems.

Every refusal says which value of which key is wrong, and what would be right.
"""

import json
import re
import tomllib
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import takewhile
from math import inf
from reprlib import repr as shortened
from typing import Any, TypeVar

from planner.support import did_you_mean

DEEPEST_NESTING = 32  # tables and lists inside each other
MOST_SIGNS = 2 * 10**6  # between keys, values and lines, read in ten seconds
_PART = r"""(?a:[\w-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')[ \t]*"""
_DEEP_KEY = re.compile(  # which tomllib reads in a time that grows with its square
    rf"(?:^|[\[{{,])[ \t]*(?:{_PART}\.[ \t]*){{{DEEPEST_NESTING}}}", re.MULTILINE
)


def parse_toml(text: str) -> dict[str, Any]:
    """Read TOML; ValueError for other or long text, deep nesting, 65 bits and more."""
    if sum(map(text.count, "=,\n")) > MOST_SIGNS:
        raise ValueError(f"more than {MOST_SIGNS:,} lines, commas and equals signs")
    if _DEEP_KEY.search(text):
        raise ValueError(f"nested deeper than {DEEPEST_NESTING}")
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise ValueError(f"nested deeper than {DEEPEST_NESTING}") from None
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:  # Python reads so many digits only
        raise ValueError("a whole number of more than 64 bits") from None
    _check_toml([table])
    return table


def _check_toml(values: Iterable[object], depth: int = 0) -> None:
    if depth > DEEPEST_NESTING:
        raise ValueError(f"nested deeper than {DEEPEST_NESTING}")
    for value in values:
        if isinstance(value, int) and abs(value) >= 2**63:  # as TOML has it
            raise ValueError("a whole number of more than 64 bits")
        if isinstance(value, dict | list):
            _check_toml(value.values() if isinstance(value, dict) else value, depth + 1)


def toml_text(text: str) -> str:
    """A text as TOML writes it, with JSON's escapes and one for DEL."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def without_tables(text: str, headers: re.Pattern[str]) -> str:
    """TOML without the tables whose lines of brackets match; comments above stay.

    So do those at the end of such a table, which are above the next one.
    """
    tables = re.split(r"^(?=[ \t]*\[)", text, flags=re.M)
    kept = (_remarks(table) if headers.match(table) else table for table in tables)
    return "".join(kept).rstrip()


def _remarks(table: str) -> str:
    """The comments with which a table ends."""
    lines = reversed(table.splitlines(keepends=True))
    own = takewhile(lambda line: line.lstrip().startswith("#"), lines)
    return "".join(reversed([*own]))


def toml_key(name: str) -> str:
    """A key as TOML writes it."""
    return name if re.fullmatch(r"(?a:[\w-])+", name) else toml_text(name)


def is_plain(name: str) -> bool:
    """Whether a name can stand in tables, pages, terminals and firmware.

    Control characters and marks that turn the order of writing around would do
    something there, a backslash at the end of a line joins the next one to it, and
    blanks at either end are lost.
    """
    return name.isprintable() and not name.endswith("\\") and name == name.strip()


LARGEST_NUMBER = 1e12  # numbers beyond it overflow somewhere
T = TypeVar("T")
Fits = Callable[[object], bool]


class Table:
    """A TOML table of which every key is known; any, if none are named.

    Its dotted name is empty for a whole file. Values without `otherwise` must be there.
    """

    def __init__(
        self, values: object, where: str = "", known: Collection[str] = ()
    ) -> None:
        if not isinstance(values, Mapping):
            raise ValueError(f"{where} must be a table, got {shortened(values)}")
        self.values, self.where = values, where
        for key in values.keys() - set(known or values):
            place, near = where or "the file", did_you_mean(str(key), known)
            raise ValueError(f"{place} has no key {key!r}; {near}")

    def __contains__(self, key: str) -> bool:
        return key in self.values

    def get(self, key: str) -> object:
        """A value that must be there."""
        if key not in self.values:
            raise ValueError(f"{self._place(key)} is missing")
        return self.values[key]

    def text(self, key: str, otherwise: str | None = None) -> str:
        """A text."""
        return str(self._of("a text", key, _is_text, otherwise))

    def texts(
        self, key: str, otherwise: Sequence[str] | None = None
    ) -> tuple[str, ...]:
        """A list of texts."""
        return tuple(self._of("a list of texts", key, _list_of(_is_text), otherwise))

    def number(self, key: str, otherwise: float | None = None) -> float:
        """A finite number."""
        return float(self._of("a number", key, _is_number, otherwise))

    def exact(self, key: str) -> float:
        """A finite number as it is written: a whole one is an int."""
        return self._of("a number", key, _is_number)

    def numbers(self, key: str, count: int = 0, what: str = "") -> Any:
        """A list of finite numbers: any, or so many, and what they are."""
        given = self._of("a list of numbers", key, _list_of(_is_number))
        found = list(map(float, given))
        if count and len(found) != count:
            raise ValueError(f"{self._place(key)} is {what}; got {found}")
        return tuple(found)

    def whole(self, key: str, otherwise: int | None = None) -> int:
        """A whole number."""
        return int(self._of("a whole number", key, lambda v: type(v) is int, otherwise))

    def list(self, key: str) -> list[object]:
        """A list."""
        return list(self._of("a list", key, _list_of(lambda item: True)))

    def table(self, key: str, known: Collection[str] = ()) -> "Table":
        """A table of known keys, or of any; empty if left out."""
        return Table(self.values.get(key, {}), self._place(key), known)

    def gains(self, key: str, required: bool = False) -> dict[str, float]:
        """A table of numbers."""
        if required:
            self.get(key)
        inner = self.table(key)
        return {name: inner.number(name) for name in inner.values}

    def tables(self, key: str, known: Collection[str] = ()) -> "dict[str, Table]":
        """The tables in a table by their names, each with its known keys."""
        inner = Table(self.get(key), self._place(key))
        return {
            name: Table(values, inner._place(name), known)
            for name, values in inner.values.items()
        }

    def make(self, kind: Callable[..., T], **given: object) -> T:
        """An object of the given values; a refusal names the place."""
        try:
            return kind(**given)
        except ValueError as error:
            raise ValueError(f"{self.where}: {error}") from error

    def _of(self, kind: str, key: str, fits: Fits, otherwise: object = None) -> Any:
        if otherwise is not None and key not in self.values:
            return otherwise
        value = self.get(key)
        if fits(value):
            return value
        hint = ""
        if isinstance(value, float | int) and LARGEST_NUMBER < abs(value) < inf:
            hint = f"; none beyond {LARGEST_NUMBER:g} is taken"
        wanted = f"must be {kind}, got {shortened(value)}{hint}"
        raise ValueError(f"{self._place(key)} {wanted}")

    def _place(self, key: str) -> str:
        return f"{self.where}.{key}" if self.where else key


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return -LARGEST_NUMBER <= value <= LARGEST_NUMBER


def _list_of(fits: Fits) -> Fits:
    return lambda value: isinstance(value, list) and all(map(fits, value))
