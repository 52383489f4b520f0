"""TOML from users: whatever cannot be read is refused with one kind of error."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from typing import Any

LARGEST = 2**63  # as the TOML specification has it
DEEPEST = 32  # tables and lists inside each other


def parse_toml(text: str) -> dict[str, Any]:
    """Read TOML.

    Raises:
        ValueError: It is not TOML, nested too deeply, or has a whole number of more
            than 64 bits.
    """
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise ValueError(f"nested deeper than {DEEPEST}") from None
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:  # Python reads so many digits only
        raise ValueError("a whole number of more than 64 bits") from None
    _check([table])
    return table


def _check(values: Iterable[Any], depth: int = 0) -> None:
    if depth > DEEPEST:
        raise ValueError(f"nested deeper than {DEEPEST}")
    for value in values:
        if isinstance(value, int) and abs(value) >= LARGEST:
            raise ValueError("a whole number of more than 64 bits")
        if isinstance(value, dict | list):
            _check(value.values() if isinstance(value, dict) else value, depth + 1)
