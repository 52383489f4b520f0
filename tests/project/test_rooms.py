"""Front doors are clear: what they offer hides no module or folder behind them."""

import ast
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
