"""Templates of the pages, their style and their script."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

if TYPE_CHECKING:
    from jinja2 import Environment, Template


def render(name: str, **values: Any) -> str:
    """The text of one of this folder's templates, filled in."""
    return template(name).render(**values)


def template(name: str) -> Template:
    """A template and all that it includes, compiled."""
    return _environment().get_template(name)


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    environment = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["plain"] = Markup  # for our own SVG, style and script
    environment.filters["breakable"] = _breakable
    return environment


def _breakable(name: str) -> Markup:
    """A name that may go on in the next line after each underscore."""
    return escape(name).replace("_", Markup("_<wbr>"))


def _text(name: str) -> str:
    return files(__name__).joinpath(name).read_text()
