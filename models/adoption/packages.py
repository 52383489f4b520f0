"""Files of ROS packages, which a URDF names by its package wherever that lies."""

import os
import re
from contextlib import suppress
from pathlib import Path

from planner.support import read_file

FILE = re.compile(r"""package://([^/"']+)/([^"']+)""")


def with_packages(text: str, folder: Path) -> str:
    """A URDF that names files of packages that are there by paths from its folder."""
    return FILE.sub(lambda name: _found(folder.resolve(), name), text)


def _found(folder: Path, name: re.Match[str]) -> str:
    """A file of a package above or beside the URDF, which may be in it itself."""
    above = (folder, *folder.parents[:4])  # a few folders up
    places = [at / name[2] for at in above if _called(at) == name[1]]
    for at in above:  # a package is often kept in a folder of another name
        places += [at.joinpath(*name.groups()), *[at / name[2]] * (not _called(at))]
    found = next(filter(os.path.isfile, places), None)
    return os.path.relpath(found, folder) if found else name.group()


def _called(folder: Path) -> str:
    """What the package in a folder is called; empty where nothing there says so."""
    text = ""
    with suppress(OSError):
        text = read_file(folder / "package.xml", 10**5).decode(errors="replace")
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    return (re.findall(r"<name>([^<]*)</name>", text) or [""])[0].strip()
