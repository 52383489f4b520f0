"""Elements of an extended system by name: fields, and brackets of them.

An element is written `g1_1`, `[g1_1,g2_2]` or, with generators counted from 1 over all
fields in order of declaration, `1` and `[1,2]`. Here names become trees and trees
become names, columns and degrees.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

from planner.errors import unknown
from planner.systems.fields import VectorField, lie_bracket
from planner.systems.strata import StratifiedSystem

Tree = Any  # a field's name, or a pair of trees

MOST_BRACKETS = 20  # in one element; the Hall basis up to it has 200 000 elements
TOKEN = re.compile(r"\s*([\[\],]|\w+)")


def parse(text: str, system: StratifiedSystem) -> Tree:
    """The tree of field names behind an element's name.

    Raises:
        ValueError: The text is no element, or names a field the system does not have.
    """
    tree = parse_names(text)
    names = list(system.fields)

    def resolve(name: str) -> str:
        if name in system.fields:
            return name
        if name.isdigit() and 1 <= int(name) <= len(names):
            return names[int(name) - 1]
        if name.isdigit():
            raise ValueError(
                f"element {text}: generators are numbered 1 to {len(names)}"
            )
        raise ValueError(f"element {text}: field {name} {unknown(name, system.fields)}")

    return relabel(tree, resolve)


def parse_names(text: str) -> Tree:
    """The tree behind a bracket expression, leaves as written."""
    tokens = TOKEN.findall(text)
    if "".join(tokens) != re.sub(r"\s", "", text):
        raise ValueError(f"element {text!r} is neither a field nor a bracket [a,b]")
    if text.count("[") > MOST_BRACKETS:
        raise ValueError(f"element has more than {MOST_BRACKETS} brackets; use fewer")
    stream = iter(tokens)
    tree = _read(stream, text)
    if next(stream, None) is not None:
        raise ValueError(
            f"element {text!r} goes on after its end; write a field or [a,b]"
        )
    return tree


def _read(tokens: Iterator[str], text: str) -> Tree:
    token = next(tokens, "")
    if token == "[":
        left = _read(tokens, text)
        _expect(tokens, ",", text)
        right = _read(tokens, text)
        _expect(tokens, "]", text)
        return (left, right)
    if not token or token in ",]":
        raise ValueError(f"element {text!r} is neither a field nor a bracket [a,b]")
    return token


def _expect(tokens: Iterator[str], mark: str, text: str) -> None:
    if next(tokens, "") != mark:
        raise ValueError(f"element {text!r} lacks a {mark!r}; write a field or [a,b]")


def name_of(tree: Tree) -> str:
    """The element's name, without spaces."""
    if isinstance(tree, str):
        return tree
    return f"[{name_of(tree[0])},{name_of(tree[1])}]"


def relabel(tree: Tree, label: Callable[[str], str]) -> Tree:
    """The same tree with other leaves."""
    if isinstance(tree, str):
        return label(tree)
    return (relabel(tree[0], label), relabel(tree[1], label))


def leaves(tree: Tree) -> tuple[str, ...]:
    """Leaves from left to right; their number is the element's degree."""
    return (tree,) if isinstance(tree, str) else leaves(tree[0]) + leaves(tree[1])


def column(tree: Tree, system: StratifiedSystem) -> VectorField:
    """The element as a vector field."""
    if isinstance(tree, str):
        return system.fields[tree]
    left, right = (column(branch, system) for branch in tree)
    return lie_bracket(left, right, system.state)
