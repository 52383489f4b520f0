"""Whether installed packages are those that are wanted, file by file.

A checkout pins versions in `scripts/constraints*.txt`, with the hashes of the archives
that pip may install; elsewhere the package's own requirements are all there is. What an
archive held is compared with the hashes that pip has written down as it unpacked it.
"""

from __future__ import annotations

import csv
import hashlib
from base64 import urlsafe_b64encode
from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement

PINS = Path(__file__).resolve().parents[1] / "scripts"
BUILDING = ("setuptools",)  # never loaded


def differences() -> Iterator[tuple[str, str]]:
    """What is wanted, and what is there instead, of packages that are installed."""
    for wanted in _wanted():
        if wanted.name in BUILDING:
            continue
        try:
            found = distribution(wanted.name)
        except PackageNotFoundError:  # of an extra, or somebody finds out at once
            continue
        name = f"{wanted.name}{wanted.specifier}"
        if not wanted.specifier.contains(found.version, prereleases=True):
            yield name, f"{wanted.name} {found.version}, wanted {wanted.specifier}"
        for path in _changed(found):
            yield name, f"{path} is not as it was installed"


def _wanted() -> list[Requirement]:
    """What the constraints pin, or the package requires where there are none."""
    texts = [path.read_text() for path in PINS.glob("constraints*.txt")]
    lines = [line for text in texts for line in text.splitlines() if "==" in line[:99]]
    if not texts:
        lines = distribution("stratawalk").requires or []
    wanted = (Requirement(line.removesuffix("\\")) for line in lines)
    here = {"extra": ""}
    return [one for one in wanted if one.marker is None or one.marker.evaluate(here)]


def _changed(found: Distribution) -> Iterator[Path]:
    """Files of a package that are gone, or are not what their hashes say."""
    listed = csv.reader((found.read_text("RECORD") or "").splitlines())
    for name, sealed, *_ in listed:  # `found.files` leaves out what is gone
        kind, _, wanted = sealed.partition("=")
        if not wanted or name.startswith(".."):  # programs name their Python
            continue
        path = Path(str(found.locate_file(name)))
        try:
            digest = hashlib.new(kind, path.read_bytes()).digest()
        except OSError:
            digest = b""
        if urlsafe_b64encode(digest).rstrip(b"=") != wanted.encode():
            yield path
