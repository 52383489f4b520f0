"""Public functions say what they do, and document the arguments they have."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [
    p
    for layer in ("planner", "models", "sim")
    for p in sorted((ROOT / layer).rglob("*.py"))
]
SECTION = re.compile(r"^(Args|Attributes|Returns|Raises|Yields):$", re.MULTILINE)


def name_of(path):
    return str(path.relative_to(ROOT))


def public(nodes):
    """Public functions, classes and their methods, from the top of a module down."""
    for node in nodes:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and node.name[0] != "_":
            yield node
            if isinstance(node, ast.ClassDef):
                yield from public(node.body)


def documented_arguments(docstring):
    """Names in the Args section, in order; None if there is no such section."""
    parts = SECTION.split(docstring)
    if "Args" not in parts:
        return None
    section = parts[parts.index("Args") + 1]
    return re.findall(r"^    \*{0,2}(\w+):", section, re.MULTILINE)


def arguments(function):
    given = function.args
    names = [a.arg for a in (*given.posonlyargs, *given.args, given.vararg) if a]
    names += [a.arg for a in (*given.kwonlyargs, given.kwarg) if a]
    return [name for name in names if name not in ("self", "cls")]


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_everything_public_has_a_docstring(path):
    module = ast.parse(path.read_text())
    bare = [node.name for node in public(module.body) if not ast.get_docstring(node)]
    assert ast.get_docstring(module), path
    assert bare == []


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_documented_arguments_are_those_of_the_signature(path):
    wrong = {}
    for node in public(ast.parse(path.read_text()).body):
        if isinstance(node, ast.ClassDef):
            continue
        documented = documented_arguments(ast.get_docstring(node) or "")
        if documented is not None and documented != arguments(node):
            wrong[node.name] = (documented, arguments(node))
    assert wrong == {}
