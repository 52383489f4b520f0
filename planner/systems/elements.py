"""Elements of an extended system by name: fields and brackets of fields.

An element is written as `g1_1` or `[g1_1,g2_2]`; `1` and `[1,2]` count all fields of
the system in order of declaration. In code an element is a tree of names, and its text
is its name.
"""

import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from planner.errors import message, require_known
from planner.lie.hall import Bracket
from planner.systems.fields import VectorField, lie_bracket
from planner.systems.strata import StratifiedSystem

Tree = Any  # the name or number of a field, or a `Bracket` of trees

MOST_BRACKETS = 20  # in one element; two generators have 200 000 elements up to there


def parse(text: str, system: StratifiedSystem) -> Tree:
    """The tree of field names that an element's name stands for in a system."""
    names = list(system.fields)

    def resolve(name: str) -> str:
        if name in names or not name.isdigit():
            require_known(f"element {text}: field {name}", name, names)
            return name
        if not 1 <= int(name) <= len(names):
            raise ValueError(message("numbered", text=text, count=len(names)))
        return names[int(name) - 1]

    return relabel(parse_names(text), resolve)


def parse_names(text: str) -> Tree:
    """The tree that a bracket expression stands for, with the leaves as written."""
    tokens = re.findall(r"\s*([\[\],]|\w+)", text)
    if "".join(tokens) != re.sub(r"\s", "", text):
        raise ValueError(f"element {text!r} is neither a field nor a bracket [a,b]")
    if text.count("[") > MOST_BRACKETS:
        raise ValueError(f"element has more than {MOST_BRACKETS} brackets; use fewer")
    stream = iter(tokens)
    tree = _read(stream, text)
    if next(stream, None) is not None:
        raise ValueError(message("goes_on", text=text))
    return tree


def _read(tokens: Iterator[str], text: str) -> Tree:
    token = next(tokens, "")
    if token != "[":
        if not token or token in ",]":
            raise ValueError(f"element {text!r} is neither a field nor a bracket [a,b]")
        return token
    branches = []
    for mark in ",]":
        branches.append(_read(tokens, text))
        if next(tokens, "") != mark:
            raise ValueError(message("unclosed", text=text, mark=mark))
    return Bracket(*branches)


def relabel(tree: Tree, label: Callable[[Any], Any]) -> Tree:
    """The same tree with the leaves renamed."""
    if isinstance(tree, Bracket):
        return Bracket(relabel(tree.left, label), relabel(tree.right, label))
    return label(tree)


@cache
def leaves(tree: Tree) -> tuple[Any, ...]:
    """Leaves from left to right; their number is the degree of the element."""
    if isinstance(tree, Bracket):
        return (*leaves(tree.left), *leaves(tree.right))
    return (tree,)


def column(tree: Tree, system: StratifiedSystem) -> VectorField:
    """The vector field of an element."""
    if isinstance(tree, Bracket):
        left, right = column(tree.left, system), column(tree.right, system)
        return lie_bracket(left, right, system.state)
    return system.fields[tree]
