"""Files of ROS packages, which a URDF names by its package wherever that lies."""

import os
import re
from pathlib import Path

from planner.support import read_file

FILE = re.compile(r"""package://([^/"']+)/([^"']+)""")
PARENTS = 4  # folders above a URDF in which its packages are looked for


def with_packages(text: str, folder: Path) -> str:
    """A URDF that names files of packages that are there by paths from its folder."""
    return FILE.sub(lambda name: _found(folder.resolve(), name), text)


def _found(folder: Path, name: re.Match[str]) -> str:
    """A file of a package above or beside the URDF, which may be in it itself."""
    above = (folder, *folder.parents[:PARENTS])
    named = [at.joinpath(*name.groups()) for at in above]
    # a package is often kept in a folder of another name
    own = [at / name[2] for at in above if _called(at) in ("", name[1])]
    for found in filter(os.path.isfile, named + own):
        return os.path.relpath(found, folder)
    return name.group()


def _called(folder: Path) -> str:
    """What the package in a folder is called; empty where nothing there says so."""
    file = folder / "package.xml"
    text = read_file(file).decode(errors="replace") if file.is_file() else ""
    return (re.findall(r"<name>\s*([^<]*?)\s*</name>", text) or [""])[0]
