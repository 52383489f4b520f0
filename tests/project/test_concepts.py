"""Concepts are few: small front doors, types that tell, one value a name."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = [
    path
    for package in ("planner", "models", "sim", "scripts")
    for path in sorted((ROOT / package).rglob("*.py"))
]


@pytest.mark.parametrize(
    ("package", "most"), [("planner", 60), ("models", 40), ("sim", 40)]
)
def test_front_doors_are_small(package, most):
    stub = ast.parse((ROOT / package / "__init__.pyi").read_text())
    assert 10 < sum(len(node.names) for node in stub.body) <= most


def test_few_lines_take_anything():
    def lines_of_any(path):
        nodes = ast.walk(ast.parse(path.read_text()))
        return {n.lineno for n in nodes if isinstance(n, ast.Name) and n.id == "Any"}

    assert sum(len(lines_of_any(path)) for path in FILES) <= 120


def number(node):
    """The value of a number that is written down, else None."""
    try:
        value = eval(compile(ast.Expression(node), "", "eval"), {"__builtins__": {}})
    except Exception:
        return None
    return value if type(value) in (int, float) else None


def constants(module):
    """Names and values of the module's own assignments, one by one."""
    for node in module.body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        for target in targets:
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                yield from zip(target.elts, node.value.elts, strict=True)
            else:
                yield target, node.value


def test_no_name_of_a_constant_has_three_values():
    values = defaultdict(lambda: defaultdict(list))
    for path in FILES:
        for target, node in constants(ast.parse(path.read_text())):
            name = getattr(target, "id", "")
            if name.isupper() and (value := number(node)) is not None:
                values[name][value].append(str(path.relative_to(ROOT)))
    assert {name: dict(v) for name, v in values.items() if len(v) > 2} == {}
