"""The project's own rules that neither ruff nor import-linter can express.

Who imports whom is configured in `pyproject.toml`, under `[tool.importlinter]`.
"""

import ast
import importlib.util
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LAYERS = ("planner", "models", "sim", "scripts", "examples", "tests")
HEAVY = (
    "mujoco", "numpy", "scipy", "sympy", "imageio", "PIL", "rich", "shapely",
    "matplotlib", "contourpy", "yaml", "jinja2", "pyarrow", "dask", "distributed",
    "filelock",
)  # fmt: skip
LONGEST_FILE = 300  # lines

FILES = [path for layer in LAYERS for path in sorted((ROOT / layer).rglob("*.py"))]


def test_every_contract_about_imports_is_kept():
    linter = Path(sys.executable).with_name("lint-imports")
    words = [linter, "--no-logo", "--no-cache"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    assert "KEPT" in done.stdout


def test_files_are_short():
    lines = {path: len(path.read_text().splitlines()) for path in FILES}
    assert Path(__file__).resolve() in lines
    assert [str(path) for path, n in lines.items() if n > LONGEST_FILE] == []


CHANGING = re.compile(r"^@dataclass(?!.*frozen=True).*\nclass (\w+)", re.MULTILINE)


def assigned(tree):
    """Names of attributes that are assigned to."""
    names = (node for node in ast.walk(tree) if isinstance(node, ast.Attribute))
    return {name.attr for name in names if isinstance(name.ctx, ast.Store)}


def test_dataclasses_whose_fields_no_line_of_their_module_changes_are_frozen():
    found = []
    for text in (path.read_text() for path in FILES):
        if names := CHANGING.findall(text):
            for node in (tree := ast.parse(text)).body:
                if isinstance(node, ast.ClassDef) and node.name in names:
                    items = (n for n in node.body if isinstance(n, ast.AnnAssign))
                    fields = {item.target.id for item in items}
                    found += [node.name] * (not fields & assigned(tree))
    assert found == []


def declared(tree):
    """Dataclasses of a module, with what their decorators say, as text."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            for decorator in map(ast.unparse, node.decorator_list):
                if decorator.startswith("dataclass"):
                    yield node, decorator


STATE = {"Search", "WindowSearch", "_Budget", "Link", "Playback"}


def test_dataclasses_are_frozen_but_for_those_of_work_that_goes_on():
    """Searches, budgets, and what is connected or played."""
    library = [path for path in FILES if path.relative_to(ROOT).parts[0] != "tests"]
    every = [pair for path in library for pair in declared(ast.parse(path.read_text()))]
    assert {node.name for node, text in every if "frozen=True" not in text} == STATE


ARRAYS = re.compile(r"(?<!\w)Array(?!\w)")


@pytest.mark.parametrize(
    ("layer", "least"),
    [("planner", 10), ("models", 10), ("sim/fitting", 4), ("sim/export", 1),
     ("sim/optimisation", 2)],
)  # fmt: skip
def test_what_holds_arrays_is_compared_by_identity(layer, least):
    """Arrays that are equal have no truth value, and arrays have no hash."""
    found, seen = [], 0
    for path in (path for path in FILES if ROOT / layer in path.parents):
        for node, decorator in declared(ast.parse(path.read_text())):
            items = (n for n in node.body if isinstance(n, ast.AnnAssign))
            types = [ast.unparse(item.annotation) for item in items]
            if any(ARRAYS.search(t) and "Callable" not in t for t in types):
                seen += 1
                found += [node.name] * ("eq=False" not in decorator)
    assert found == []
    assert seen >= least


@pytest.mark.parametrize("layer", ["planner", "models"])
def test_a_zip_that_may_leave_some_out_says_why(layer):
    """In a comment beside it, or above it; others take sequences of one length."""
    silent = []
    for path in (path for path in FILES if ROOT / layer in path.parents):
        lines = ["", *path.read_text().splitlines()]
        for above, line in zip(lines, lines[1:], strict=False):
            if "strict=False" in line and "#" not in above + line:
                silent.append((path.name, line.strip()))
    assert silent == []


@pytest.mark.parametrize("name", ["planner", "models", "sim"])
def test_generic_names_resolve_to_this_checkout(name):
    found = importlib.util.find_spec(name).origin
    assert Path(found) == ROOT / name / "__init__.py"


def test_every_package_is_packaged_and_scripts_are_not():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    initialised = (path.parent for path in FILES if path.name == "__init__.py")
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


def test_system_without_a_body_is_planned_without_mujoco():
    program = (
        "import sys, sim.cli\n"
        "code = sim.cli.main(['plan', 'unicycle', '--json'])\n"
        "sys.exit(code or 'mujoco' in sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=True)
