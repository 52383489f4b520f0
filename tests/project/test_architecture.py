"""The project's own rules: who imports whom, how, and how long files may be."""

import ast
import importlib.util
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.offenders import no

ROOT = Path(__file__).resolve().parents[2]
LAYERS = {
    "planner": {"planner"},
    "models": {"planner", "models"},
    "sim": {"planner", "models", "sim"},
    "scripts": {"planner", "models", "sim", "scripts"},
    "examples": {"planner", "models", "sim"},
}
HOUSES = {"planner", "models", "sim"}
ONLY_IN = {
    "mujoco": {"models", "sim", "scripts"},
    "sympy": {"planner", "models", "examples"},
    "imageio": {"sim"},
    "imageio_ffmpeg": {"sim"},
    "PIL": {"sim"},
    "matplotlib": {"sim", "scripts"},
    "contourpy": {"sim"},
    "rich": {"sim"},
    "shapely": {"sim"},
    "jinja2": {"sim"},
    "markupsafe": {"sim"},
    "casadi": {"planner", "sim"},
    "ompl": {"sim"},
    "yaml": {"sim"},
    "pyarrow": {"sim"},
    "dask": {"sim"},
    "distributed": {"sim"},
    "filelock": {"sim"},
}
HEAVY = (
    "mujoco", "numpy", "scipy", "sympy", "imageio", "PIL", "rich", "shapely",
    "matplotlib", "contourpy", "yaml", "jinja2", "pyarrow", "dask", "distributed",
    "filelock",
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


def top(name):
    return name.partition(".")[0]


def tops(path):
    return {top(name) for name in imports(path)}


def test_there_are_files_to_check():
    assert {layer_of(path) for path in SOURCES} == LAYERS.keys()
    assert Path(__file__).resolve() in EVERY_FILE


def test_imports_point_downwards():
    ours = LAYERS.keys() | {"tests"}
    no((path, tops(path) & ours - LAYERS[layer_of(path)]) for path in SOURCES)


def test_examples_go_through_the_front_doors():
    examples = [path for path in SOURCES if layer_of(path) == "examples"]
    inner = {path: [n for n in imports(path) if "." in n] for path in examples}
    no((path, [n for n in names if top(n) in HOUSES]) for path, names in inner.items())


def test_imports_are_absolute():
    no(
        (path, [name for name in imports(path) if name.startswith(".")])
        for path in EVERY_FILE
    )


def test_libraries_stay_in_their_layers():
    def strayed(path):
        where = layer_of(path)
        return {name for name in tops(path) if where not in ONLY_IN.get(name, LAYERS)}

    no((path, strayed(path)) for path in SOURCES)


def test_files_are_short():
    lines = ((path, len(path.read_text().splitlines())) for path in EVERY_FILE)
    no((path, f"{n} lines" if n > LONGEST else "") for path, n in lines)


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
