"""How the pages of this folder become a site: `sphinx-build -W docs docs/_build`.

The site needs no network: formulas are MathML, and fonts are the reader's own.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert

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


def read_outside(app: Any, docname: str, source: list[str]) -> None:
    """Fill the pages that stand for files beside this folder, links set right."""
    for name, page in OUTSIDE.items():
        if f"{docname}.md" == page:
            source[0] = _moved((ROOT / name).read_text())


def _moved(text: str) -> str:
    for name, page in OUTSIDE.items():
        text = text.replace(f"]({name})", f"]({page})")
    for name in PLAIN:
        text = text.replace(f"[Apache License 2.0]({name})", "Apache License 2.0")
        text = text.replace(f"]({name})", f"](../{name})")
    return text.replace("](docs/", "](")


def inline_formula(writer: Any, node: Any) -> None:
    """A formula within a line."""
    _write(writer, node, "inline")


def displayed_formula(writer: Any, node: Any) -> None:
    """A formula of its own line, with its number where it has one."""
    _write(writer, node, "block")


def _write(writer: Any, node: Any, display: str) -> None:
    from docutils.nodes import SkipNode

    writer.body.append(convert(node.astext(), display=display))
    raise SkipNode


def setup(app: Any) -> dict[str, bool]:
    """What Sphinx calls when it reads this file."""
    app.connect("source-read", read_outside)
    app.add_html_math_renderer(
        "mathml", (inline_formula, None), (displayed_formula, None)
    )
    return {"parallel_read_safe": True, "parallel_write_safe": True}
