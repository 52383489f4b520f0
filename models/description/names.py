"""Names in robots: text that every file can hold and every terminal can show.

A name goes into tables, pages and the firmware of servos. Control characters and marks
that turn the order of writing around would do something there instead of being read,
and a backslash at the end of a line joins the next one to it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ModelError

if TYPE_CHECKING:
    import mujoco

REMEDY = "use printable characters, and no backslash at the end"


def is_plain(name: str) -> bool:
    """Whether a name can stand wherever names are written."""
    return name.isprintable() and not name.endswith("\\")


def check_name(name: str, source: str) -> None:
    """Refuse a name that cannot stand wherever names are written."""
    if not is_plain(name):
        raise ModelError(
            f"{name!r} is no name for a part or a robot: {source}; {REMEDY}"
        )


def check_names(model: mujoco.MjModel, source: str) -> None:
    """Refuse a compiled model in which something has such a name."""
    for name in model.names.split(b"\0"):
        try:
            check_name(name.decode(), source)
        except UnicodeDecodeError as error:
            raise ModelError(
                f"a name of it is not text, {error}: {source}; write names in UTF-8"
            ) from error
