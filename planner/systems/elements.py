"""Elements of an extended system by name: fields and brackets of fields.

An element is written as `g1_1` or `[g1_1,g2_2]`; `1` and `[1,2]` count all fields of
the system in order of declaration. In code an element is a tree of names.
"""

import re
from collections.abc import Callable, Iterator
from typing import Any

from planner.errors import message, require_known
from planner.systems.fields import VectorField, lie_bracket
from planner.systems.strata import StratifiedSystem

Tree = Any  # the name of a field, or a pair of trees

MOST_BRACKETS = 20  # in one element; two generators have 200 000 elements up to there
TOKEN = re.compile(r"\s*([\[\],]|\w+)")


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
    tokens = TOKEN.findall(text)
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
    return tuple(branches)


def name_of(tree: Tree) -> str:
    """The name of an element, without spaces."""
    return tree if isinstance(tree, str) else f"[{name_of(tree[0])},{name_of(tree[1])}]"


def relabel(tree: Tree, label: Callable[[str], str]) -> Tree:
    """The same tree with the leaves renamed."""
    if isinstance(tree, str):
        return label(tree)
    return (relabel(tree[0], label), relabel(tree[1], label))


def leaves(tree: Tree) -> tuple[str, ...]:
    """Leaves from left to right; their number is the degree of the element."""
    return (tree,) if isinstance(tree, str) else leaves(tree[0]) + leaves(tree[1])


def word_of(tree: Tree) -> tuple[str, ...]:
    """Fields of the flows that realise an element, eq. (20), without their signs."""
    if isinstance(tree, str):
        return (tree,)
    left, right = word_of(tree[0]), word_of(tree[1])
    return (*left, *right, *left[::-1], *right[::-1])


def column(tree: Tree, system: StratifiedSystem) -> VectorField:
    """The vector field of an element."""
    if isinstance(tree, str):
        return system.fields[tree]
    left, right = (column(branch, system) for branch in tree)
    return lie_bracket(left, right, system.state)
