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
    *(ROOT / "scripts" / name for name in ("setup", "run", "test", "pin", "smoke")),
    ROOT / ".ci" / "run",
]
WALKING, EXTRAS = PINS = [
    ROOT / "scripts" / name for name in ("constraints.txt", "constraints-test.txt")
]
PIN = re.compile(r"^(\S+)==([^ ;]+)", re.MULTILINE)


def pins(*files):
    """Pinned versions by the packages' names."""
    return {
        canonicalize_name(name): version
        for file in files or PINS
        for name, version in PIN.findall(file.read_text())
    }


@pytest.mark.parametrize("path", SHELL, ids=lambda path: path.name)
def test_scripts_are_executable_posix_shell(path):
    assert path.stat().st_mode & 0o111
    assert path.read_text().startswith("#!/bin/sh\n")
    assert subprocess.run(["sh", "-n", path]).returncode == 0


def unsatisfied(requirements, pinned):
    """Requirements that no pin is for, or a pin of a version that they refuse."""
    return [
        text
        for text in requirements
        for wanted in [Requirement(text)]
        if not wanted.specifier.contains(pinned.get(canonicalize_name(wanted.name), ""))
    ]


def test_every_requirement_is_pinned_to_a_version_it_allows():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = [r for group in project["optional-dependencies"].values() for r in group]
    assert unsatisfied(project["dependencies"], pins(WALKING)) == []
    itself = {project["name"]: project["version"]}  # extras name others
    assert unsatisfied(extras, pins() | itself) == []


def test_no_package_is_pinned_twice_or_without_a_hash():
    assert pins(WALKING).keys() & pins(EXTRAS).keys() == set()
    for file in PINS:
        text = file.read_text()
        packages = PIN.split(text)[3::3]  # what stands behind each name and version
        assert len(packages) == len(PIN.findall(text))
        assert all("--hash=sha256:" in package for package in packages)


def test_debians_python_can_install_every_pin():
    asked = {
        canonicalize_name(d.name): SpecifierSet(d.metadata.get("Requires-Python", ""))
        for d in distributions()
        if d.version == pins().get(canonicalize_name(d.name))
    }
    assert len(asked) > 50
    assert [name for name, versions in asked.items() if "3.11.2" not in versions] == []


@pytest.mark.parametrize("path", [*SHELL, *PINS], ids=lambda path: path.name)
def test_set_up_names_no_host(path):
    assert re.findall(r"https?://|index-url|find-links|@ file:", path.read_text()) == []
