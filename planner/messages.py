"""Tables of our packages, such as those of what is said where something is refused."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from importlib.resources import files
from typing import Any


def shipped_tables(package: str, name: str) -> dict[str, Any]:
    """The tables of a TOML file that lies in one of our packages."""
    return tomllib.loads((files(package) / name).read_text("utf-8"))


def sentences(package: str, name: str) -> Callable[..., str]:
    """Says a sentence of such a file by its key, facts put in where they belong."""
    tables = shipped_tables(package, name)
    return lambda key, /, **facts: str(tables[key]).format(**facts)


message = sentences("planner", "refusals.toml")
