"""Refuse MJCF that a few words make huge: MuJoCo takes minutes to copy so much.

Two nested `replicate` elements of 300 copies compile for as long as a walk takes, and
cannot be interrupted; ten thousand plain geoms are read in a fifth of a second.
"""

from __future__ import annotations

import re
from pathlib import Path

import mujoco

from models.errors import ModelError

MOST = 10_000  # copies of one element
TAG = re.compile(r"<replicate\b([^>]*?)(/?)>|</replicate\s*>")
COUNT = re.compile(r"\bcount\s*=\s*[\"']\s*(\d+)")


def check_replicas(path: Path) -> None:
    """Refuse a file that would copy an element more than `MOST` times.

    Files that it includes count on their own. What cannot be read is for the compiler
    to refuse.

    Raises:
        ModelError: With the number of copies.
    """
    try:
        files = mujoco.mju_getXMLDependencies(str(path))
    except mujoco.FatalError:
        return
    for file in map(Path, files):
        if file.suffix.lower() == ".xml" and file.is_file():
            copies = most_copies(file.read_text(errors="replace"))
            if copies > MOST:
                raise ModelError(
                    f"it replicates an element {copies} times: {file}; at most {MOST} "
                    "copies are taken, leave some out"
                )


def most_copies(text: str) -> int:
    """How often the innermost of nested `replicate` elements is copied."""
    nested, most = [1], 1
    for tag in TAG.finditer(text):
        if tag[0].startswith("</"):
            nested = nested[:-1] or [1]
        else:
            count = COUNT.search(tag[1])
            nested.append(nested[-1] * (int(count[1]) if count else 1))
            most = max(most, nested[-1])
            if tag[2]:
                nested.pop()
    return most
