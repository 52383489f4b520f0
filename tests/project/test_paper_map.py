"""The table at the planner's front door leads from each equation to its function."""

import importlib
import re
from functools import reduce
from pathlib import Path

import models
import planner

ROOT = Path(__file__).resolve().parents[2]
ROWS = [
    re.split(r" {2,}", line)
    for line in planner.__doc__.splitlines()
    if re.match(r"eq\.|\(\d|Sec\.|Def\.", line)
]
RANGE = re.compile(r"\((\d+)\)(?:(?:-| to )\((\d+)\))?")
CITATION = re.compile(r"eqs?\.\s(?:\(\d+\)(?:, | and | to |-|,?\n)?)+")


def numbers(text):
    """The equations that a text lists, such as `(7), (13)-(15)`."""
    spans = [(int(a), int(b or a)) for a, b in RANGE.findall(text)]
    return {number for a, b in spans for number in range(a, b + 1)}


def has(door, name):
    """Whether a door has a name, or a class at it an attribute."""
    *path, last = name.split(".")
    if not hasattr(door, [*path, last][0]):
        return False
    holder = reduce(getattr, path, door)
    return hasattr(holder, last) or last in holder.__annotations__


def doors_of(room):
    """Where the names of a module may be: at the front door or at its room's."""
    return [planner, importlib.import_module(f"planner.{room.partition('/')[0]}")]


def test_every_equation_has_a_row():
    assert set().union(*(numbers(row[0]) for row in ROWS)) == set(range(1, 21))


def test_every_row_names_functions_and_a_module_that_exist():
    for _, _, names, room in ROWS:
        for name in names.split(", "):
            first, _, rest = name.partition(".")
            doors = [models] if first == "models" else doors_of(room)
            assert any(has(door, rest if doors == [models] else name) for door in doors)
        package = "" if room.startswith("models/") else "planner/"
        module = f"{package}{room}".replace("/", ".")
        assert importlib.import_module(module).__doc__, room


def test_rows_of_equations_lead_to_modules_that_cite_them():
    for number, _, _, room in ROWS:
        if number.startswith("eq.") and not room.startswith("models/"):
            text = (ROOT / "planner" / f"{room}.py").read_text()
            assert numbers(number) <= numbers(" ".join(CITATION.findall(text))), room
