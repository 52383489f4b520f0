"""The reference has every public name, and the examples in their docstrings run."""

import ast
import doctest
import inspect
import re
from importlib import import_module

import pytest
from sphinx.pycode import ModuleAnalyzer

from tests.pages import ROOT

DOORS = ("planner", "models", "sim")
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def public(door):
    """Names at a front door, each with the module that it comes from."""
    stub = ast.parse((ROOT / door / "__init__.pyi").read_text())
    return {
        alias.asname or alias.name: f"{door}.{node.module}"
        for node in stub.body
        for alias in node.names
    }


def documentation(door, name):
    """The docstring of a function or class, or the text under a constant."""
    value = getattr(import_module(door), name)
    if inspect.isclass(value) or inspect.isfunction(inspect.unwrap(value)):
        return inspect.getdoc(value)
    texts = ModuleAnalyzer.for_module(public(door)[name]).find_attr_docs()
    return "\n".join(texts.get(("", name), []))


NAMES = [(door, name) for door in DOORS for name in public(door)]


@pytest.mark.parametrize("door", DOORS)
def test_the_reference_has_every_public_name_once(door):
    page = (ROOT / "docs" / "api" / f"{door}.md").read_text()
    lists = re.findall(rf"^\.\. public:: {door}\n\n((?:   .*\n)+)", page, re.MULTILINE)
    assert sorted(" ".join(lists).split()) == sorted(public(door))


@pytest.mark.physics
@pytest.mark.usefixtures("paged")
@pytest.mark.parametrize(("door", "name"), NAMES, ids=lambda word: word)
def test_every_public_name_has_an_example_that_runs(
    door, name, folder, monkeypatch, capsys
):
    """Examples import what they use; those that read files do so in a run folder."""
    monkeypatch.chdir(folder)
    text = documentation(door, name)
    examples = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    assert examples.examples, f"{door}.{name} has no example"
    failed, _ = doctest.DocTestRunner(optionflags=FLAGS).run(examples)
    assert not failed, capsys.readouterr().out
