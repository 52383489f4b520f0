"""Front doors are clear: they name every room behind them, and hide none."""

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("planner", "models", "sim")
STUBS = [*ROOT.glob("planner/*/__init__.pyi"), *ROOT.glob("models/*/__init__.pyi")]
ROOMS = sorted(str(stub.parent.relative_to(ROOT)) for stub in STUBS)


def exported(package):
    """Names at a package's front door."""
    stub = ast.parse((ROOT / package / "__init__.pyi").read_text())
    return {alias.asname or alias.name for node in stub.body for alias in node.names}


@pytest.mark.parametrize("package", [*PACKAGES, *ROOMS])
def test_no_name_at_the_front_door_is_that_of_a_module_or_folder(package):
    folder = ROOT / package
    inside = (path.relative_to(folder) for path in folder.rglob("*.py"))
    taken = {part for path in inside for part in path.with_suffix("").parts}
    assert exported(package) & taken == set()


def rooms_of(package):
    """Names of the folders of a package, whether they hold code or robots."""
    inside = (ROOT / package).iterdir()
    return {f.name for f in inside if f.is_dir() and not f.name.startswith("__")}


def told(package):
    """First words of the rows of the table of rooms at a front door."""
    table = import_module(package).__doc__.partition("\nRoom ")[2]
    return re.findall(r"^(\w+)  ", table, re.MULTILINE)


@pytest.mark.parametrize("package", ["models", "sim"])
def test_the_table_at_a_front_door_has_every_room_once(package):
    rows = told(package)
    assert len(rows) == len(set(rows))
    assert rooms_of(package) <= set(rows)
    others = {*rows} - rooms_of(package)
    assert all((ROOT / package / f"{row}.py").exists() for row in others)


def test_the_front_door_of_planner_names_every_room():
    named = set(re.findall(r" (\w+)/|`(\w+)`", import_module("planner").__doc__))
    assert rooms_of("planner") <= {name for pair in named for name in pair}
