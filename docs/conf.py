"""How the pages of this folder become a site: `sphinx-build -W docs docs/_build`.

The site needs no network: formulas are MathML, and fonts are the reader's own.
"""

from __future__ import annotations

import ast
import inspect
import re
import tomllib
from importlib import import_module
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.statemachine import StringList
from latex2mathml.converter import convert
from sphinx.pycode import ModuleAnalyzer
from sphinx.util.docutils import SphinxDirective

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

project = PROJECT["name"]
author = "the stratawalk authors"
copyright = f"2026, {author}"  # noqa: A001  Sphinx calls it so
version = release = PROJECT["version"]

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["_build"]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
nb_execution_mode = "cache"
nb_merge_streams = True
nb_execution_timeout = 600
nb_execution_raise_on_error = True

autodoc_member_order = "groupwise"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_preserve_defaults = True
napoleon_use_ivar = True
default_role = "code"

html_theme = "furo"
html_title = f"{project} {release}"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["columns.css"]
html_show_sphinx = False

OUTSIDE = {  # files beside this folder that are pages of the site, too
    "README.md": "readme.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
PLAIN = ("LICENSE", "CITATION.cff")
# A link of Markdown to a page of _static, which Sphinx would offer as a download.
BY_HAND = re.compile(r"\[([^\[\]]+)\]\(([./]*_static/[\w-]+\.html)\)")


def read_outside(app: Any, docname: str, source: list[str]) -> None:
    """Fill the pages that stand for files beside this folder, and set links right."""
    for name, page in OUTSIDE.items():
        if f"{docname}.md" == page:
            source[0] = _moved((ROOT / name).read_text())
    source[0] = BY_HAND.sub(r"<a href='\2'>\1</a>", source[0])


def _moved(text: str) -> str:
    for name, page in OUTSIDE.items():
        text = text.replace(f"]({name})", f"]({page})")
    for name in PLAIN:
        text = text.replace(f"[Apache License 2.0]({name})", "Apache License 2.0")
        text = text.replace(f"]({name})", f"](../{name})")
    return text.replace("](docs/", "](")


class Public(SphinxDirective):
    """Public names of a front door, each with its signature, docstring and example.

    The argument names the door, the content the names.
    """

    required_arguments = 1
    has_content = True

    def run(self) -> list[Any]:
        """What autodoc makes of the names, in the order in which they are given."""
        door = self.arguments[0]
        lines = StringList()
        for name in " ".join(self.content).split():
            for line in _directive(door, name):
                lines.append(line, self.get_location())
        section = nodes.section()
        self.state.nested_parse(lines, 0, section)
        return section.children


def _directive(door: str, name: str) -> list[str]:
    """What makes a name's entry; a constant has its value's text and no signature."""
    value = getattr(import_module(door), name)
    if inspect.isfunction(inspect.unwrap(value)):
        return [f".. autofunction:: {door}.{name}", ""]
    if not inspect.isclass(value):
        text = [f"   {line}" for line in constant_text(door, name)]
        return [f".. py:data:: {door}.{name}", "", *text, ""]
    if issubclass(value, BaseException):
        return [f".. autoexception:: {door}.{name}", ""]
    return [f".. autoclass:: {door}.{name}", "   :members:", ""]


def constant_text(door: str, name: str) -> list[str]:
    """The lines of text that stand under a constant where it is defined."""
    stub = ast.parse((ROOT / door / "__init__.pyi").read_text())
    (module,) = (n.module for n in stub.body if name in {a.name for a in n.names})
    analyzer = ModuleAnalyzer.for_module(f"{door}.{module}")
    return analyzer.find_attr_docs().get(("", name), [])


def inline_formula(writer: Any, node: Any) -> None:
    """A formula within a line."""
    _write(writer, node, "inline")


def displayed_formula(writer: Any, node: Any) -> None:
    """A formula of its own line, with its number where it has one."""
    _write(writer, node, "block")


STRETCHING = {  # brackets as high as the matrix between them
    r"\begin{pmatrix}": r"\left(\begin{matrix}",
    r"\end{pmatrix}": r"\end{matrix}\right)",
    r"\begin{bmatrix}": r"\left[\begin{matrix}",
    r"\end{bmatrix}": r"\end{matrix}\right]",
}


def _write(writer: Any, node: Any, display: str) -> None:
    formula = node.astext()
    for plain, stretching in STRETCHING.items():
        formula = formula.replace(plain, stretching)
    writer.body.append(convert(formula, display=display))
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """What Sphinx calls when it reads this file."""
    app.connect("source-read", read_outside)
    app.add_directive("public", Public)
    app.add_html_math_renderer(
        "mathml", (inline_formula, None), (displayed_formula, None)
    )
    return {"parallel_read_safe": True, "parallel_write_safe": True}
