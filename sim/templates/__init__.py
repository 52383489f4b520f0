"""Templates of pages, with their style and script, of texts and of firmware."""

from functools import cache
from importlib.resources import files
from math import degrees, inf
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template
from markupsafe import Markup, escape

BREAK = Markup("_<wbr>")
PLAIN = (".txt", ".md", ".h", ".ino")  # texts in which nothing needs to be escaped


def render(name: str, /, **values: Any) -> str:
    """The text of one of this folder's templates, filled in, its last line open."""
    return template(name).render(**values).removesuffix("\n")


def template(name: str) -> Template:
    """A template and all that it includes, compiled."""
    return _environment().get_template(name)


@cache
def _environment() -> Environment:
    here = files(__name__)
    environment = Environment(
        loader=FunctionLoader(lambda name: (here / name).read_text("utf-8")),
        autoescape=lambda name: not str(name).endswith(PLAIN),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["plain"] = Markup  # for our own SVG, style and script
    # for names, which may go on in the next line after each underscore
    environment.filters["breakable"] = lambda name: escape(name).replace("_", BREAK)
    environment.filters["mm"] = lambda m, digits=1: f"{1e3 * m:z.{digits}f} mm"
    environment.filters |= {"to": format, "degrees": degrees}
    environment.globals["inf"] = inf
    plainly = {"allow_nan": False, "separators": (",", ":")}
    environment.policies["json.dumps_kwargs"] = plainly
    return environment
