"""Set-up scripts: plain shell, every package pinned, nobody's machine in them."""

import re
import subprocess
import tomllib
from importlib.metadata import distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
SHELL = [
    *(ROOT / "scripts" / name for name in ("setup", "run", "test")),
    ROOT / ".ci" / "run",
]


def pins():
    lines = (ROOT / "scripts" / "constraints.txt").read_text().splitlines()
    pairs = (line.split("==") for line in lines if not line.startswith("#"))
    return {canonicalize_name(name): version for name, version in pairs}


@pytest.mark.parametrize("path", SHELL, ids=lambda path: path.name)
def test_scripts_are_executable_posix_shell(path):
    assert path.stat().st_mode & 0o111
    assert path.read_text().startswith("#!/bin/sh\n")
    assert subprocess.run(["sh", "-n", path]).returncode == 0


def test_every_requirement_is_pinned_to_a_version_it_allows():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"].values()
    wanted = [
        Requirement(r) for group in (project["dependencies"], *extras) for r in group
    ]
    pinned = pins() | {project["name"]: project["version"]}  # extras name others
    assert [r for r in wanted if pinned.get(canonicalize_name(r.name)) is None] == []
    assert [
        r for r in wanted if not r.specifier.contains(pinned[canonicalize_name(r.name)])
    ] == []


def test_debians_python_can_install_every_pin():
    asked = {
        canonicalize_name(d.name): SpecifierSet(d.metadata.get("Requires-Python", ""))
        for d in distributions()
        if d.version == pins().get(canonicalize_name(d.name))
    }
    assert len(asked) > 50
    assert [name for name, versions in asked.items() if "3.11.2" not in versions] == []


@pytest.mark.parametrize(
    "path", [*SHELL, ROOT / "scripts" / "constraints.txt"], ids=str
)
def test_set_up_names_no_host(path):
    assert re.findall(r"https?://|index-url|find-links|@ file:", path.read_text()) == []
