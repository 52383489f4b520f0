"""Rooms and front doors: arrows between rooms run one way, doors are used and clear."""

import ast
import graphlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HOUSES = ("planner", "models", "sim")
DOORS = {*HOUSES, "planner.support"}  # the second is of programs, not of mathematics
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts): path
    for package in (*HOUSES, "scripts")
    for path in sorted((ROOT / package).rglob("*.py"))
}


def package_of(module):
    return module.partition(".")[0]


def imported(path):
    """Modules that a file imports anywhere, of those of this project."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [name if name in MODULES else node.module for name in inner]
        else:
            continue
        yield from (name for name in names if package_of(name) in HOUSES)


def room_of(module):
    """The folder that a module lies in; a module beside the folders is its own room."""
    parts = module.split(".")
    return ".".join(parts[:2])


def arrows_between_rooms(package):
    """For each room the rooms of the same package that it imports from."""
    arrows = {}
    for module, path in MODULES.items():
        if package_of(module) == package:
            arrows.setdefault(room_of(module), set()).update(
                room_of(name) for name in imported(path) if package_of(name) == package
            )
    return {room: others - {room} for room, others in arrows.items()}


def exported(package):
    """Names at a package's front door."""
    stub = ast.parse((ROOT / package / "__init__.pyi").read_text())
    return {alias.asname or alias.name for node in stub.body for alias in node.names}


@pytest.mark.parametrize("package", HOUSES)
def test_arrows_between_rooms_run_one_way(package):
    rooms = graphlib.TopologicalSorter(arrows_between_rooms(package))
    try:
        order = tuple(rooms.static_order())
    except graphlib.CycleError as circle:
        pytest.fail(f"rooms import from one another: {' <- '.join(circle.args[1])}")
    assert len(order) > 3


@pytest.mark.parametrize("package", [*HOUSES, "scripts"])
def test_doors_are_for_those_who_come_from_outside(package):
    wrong = {
        f"{module} imports {name}"
        for module, path in MODULES.items()
        for name in imported(path)
        if package_of(module) == package
        and (name in DOORS) == (package_of(name) == package)
    }
    assert wrong == set()


@pytest.mark.parametrize("package", HOUSES)
def test_no_name_at_the_front_door_is_that_of_a_module_or_folder(package):
    inside = [name.split(".")[1:] for name in MODULES if package_of(name) == package]
    assert exported(package) & {part for parts in inside for part in parts} == set()
