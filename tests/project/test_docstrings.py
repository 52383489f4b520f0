"""Public functions say what they do, and document the arguments they have."""

import ast
import re
from pathlib import Path

from tests.offenders import no

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [
    p
    for layer in ("planner", "models", "sim")
    for p in sorted((ROOT / layer).rglob("*.py"))
]
SECTION = re.compile(r"^(Args|Attributes|Returns|Raises|Yields):$", re.MULTILINE)


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


def bare(path):
    """What is public in a file and has no docstring, the module itself first."""
    module = ast.parse(path.read_text())
    if not ast.get_docstring(module):
        yield path, "the module has no docstring"
    for node in public(module.body):
        if not ast.get_docstring(node):
            yield path, f"{node.name} has no docstring"


def misdocumented(path):
    """Functions of a file whose Args section differs from the signature."""
    for node in public(ast.parse(path.read_text()).body):
        if isinstance(node, ast.ClassDef):
            continue
        documented = documented_arguments(ast.get_docstring(node) or "")
        if documented is not None and documented != arguments(node):
            given = arguments(node)
            yield path, f"{node.name} documents {documented} and takes {given}"


def test_everything_public_has_a_docstring():
    no(fault for path in SOURCES for fault in bare(path))


def test_documented_arguments_are_those_of_the_signature():
    no(fault for path in SOURCES for fault in misdocumented(path))
