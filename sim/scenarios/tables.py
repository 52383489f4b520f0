"""Checks that the tables of paths and of obstacles share, and their refusals.

Such a table has a `kind`, which decides what its other keys are, and it holds numbers
and points.
"""

from __future__ import annotations

import reprlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, TypeGuard

from planner.support import did_you_mean
from sim.errors import UsageError
from sim.scenarios.declaration import is_number

Table = Mapping[str, Any]  # as TOML has it


def refusal(what: str, value: object, where: str, wanted: str) -> UsageError:
    """An error for a value that is not allowed.

    Args:
        what: Key of the value, to stand before it; empty where `where` ends with it.
        value: The value.
        where: Place of the value in the scenario.
        wanted: What would be allowed, to follow the word "give".
    """
    key = f"{what} = " if what else ""
    return UsageError(
        f"{key}{reprlib.repr(value)} is not allowed", where, f"give {wanted}"
    )


def is_list(value: object) -> TypeGuard[Sequence[Any]]:
    """Whether a value is a list; text is none."""
    return isinstance(value, Sequence) and not isinstance(value, str)


def numbers(
    value: object, count: int, farthest: float, what: str, where: str, wanted: str
) -> tuple[float, ...]:
    """A list of so many numbers, none beyond the farthest.

    Raises:
        UsageError: If the value is none, as `refusal` says it.
    """
    if not is_list(value) or len(value) != count:
        raise refusal(what, value, where, f"{wanted}, none beyond {farthest:g}")
    if not all(is_number(item) and abs(item) <= farthest for item in value):
        raise refusal(what, value, where, f"{wanted}, none beyond {farthest:g}")
    return tuple(map(float, value))


def require_kind(table: object, where: str, kinds: Collection[str]) -> Table:
    """The table, once its `kind` is found to be a known one.

    Raises:
        UsageError: If it is no table, or has no kind or an unknown one.
    """
    if not isinstance(table, Mapping) or not isinstance(table.get("kind"), str):
        raise refusal("", table, where, f"a table with kind = {' or '.join(kinds)}")
    if table["kind"] not in kinds:
        what = f"unknown kind {table['kind']!r}"
        raise UsageError(what, where, did_you_mean(table["kind"], kinds))
    return table


def require_keys(
    table: Table, where: str, needed: Iterable[str], allowed: Iterable[str]
) -> None:
    """Refuse a table that has an unknown key or lacks a needed one.

    Raises:
        UsageError: If so, with the key.
    """
    needed, known = tuple(needed), (*needed, *allowed)
    for key in table.keys() - {"kind", *known}:
        raise UsageError(f"unknown key {key!r}", where, did_you_mean(key, known))
    for key in needed:
        if key not in table:
            raise UsageError(f"{key} is missing", where, f"give {key}")
