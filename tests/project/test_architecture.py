"""The project's own rules: who imports whom, how, and how long files may be."""

import ast
import importlib.util
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LAYERS = {
    "planner": {"planner"},
    "models": {"planner", "models"},
    "sim": {"planner", "models", "sim"},
    "scripts": {"planner", "models", "sim", "scripts"},
}
ONLY_IN = {
    "mujoco": {"models", "sim", "scripts"},
    "sympy": {"planner", "models"},
    "imageio": {"sim"},
    "imageio_ffmpeg": {"sim"},
    "PIL": {"sim"},
    "matplotlib": {"sim", "scripts"},
    "rich": {"sim"},
    "shapely": {"sim"},
    "casadi": {"sim"},
    "ompl": {"sim"},
}
HEAVY = (
    "mujoco", "numpy", "scipy", "sympy", "imageio", "PIL", "rich", "shapely",
    "matplotlib",
)  # fmt: skip
LONGEST = 300  # lines

SOURCES = [path for layer in LAYERS for path in sorted((ROOT / layer).rglob("*.py"))]
EVERY_FILE = [*SOURCES, *sorted((ROOT / "tests").rglob("*.py"))]


def layer_of(path):
    return path.relative_to(ROOT).parts[0]


def name_of(path):
    return str(path.relative_to(ROOT))


def imports(path):
    """Names of the modules a file imports, relative ones with their dots."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." * node.level + (node.module or "")


def tops(path):
    return {name.partition(".")[0] for name in imports(path)}


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_imports_point_downwards(path):
    ours = tops(path) & (LAYERS.keys() | {"tests"})
    assert ours <= LAYERS[layer_of(path)]


@pytest.mark.parametrize("path", EVERY_FILE, ids=name_of)
def test_imports_are_absolute(path):
    assert [name for name in imports(path) if name.startswith(".")] == []


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_libraries_stay_in_their_layers(path):
    strayed = {
        name for name in tops(path) if layer_of(path) not in ONLY_IN.get(name, LAYERS)
    }
    assert strayed == set()


@pytest.mark.parametrize("path", EVERY_FILE, ids=name_of)
def test_files_are_short(path):
    assert len(path.read_text().splitlines()) <= LONGEST


@pytest.mark.parametrize("name", ["planner", "models", "sim"])
def test_generic_names_resolve_to_this_checkout(name):
    found = importlib.util.find_spec(name).origin
    assert Path(found) == ROOT / name / "__init__.py"


def test_every_package_is_packaged_and_scripts_are_not():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    initialised = (p.parent for p in SOURCES if p.name == "__init__.py")
    packages = {".".join(p.relative_to(ROOT).parts) for p in initialised}
    listed = set(settings["tool"]["setuptools"]["packages"])
    assert listed == packages - {"scripts"}


def test_help_waits_for_no_heavy_library():
    program = (
        "import sys, sim.cli\n"
        "code = sim.cli.main(['run', '--help'])\n"
        f"print(code, sorted(sys.modules.keys() & set({HEAVY})))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True
    )
    assert done.stdout.splitlines()[-1] == "0 []"
