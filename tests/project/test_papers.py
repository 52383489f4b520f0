"""Licence, citation and changelog are of this version."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_the_citation_is_of_this_version_and_licence():
    citation = (ROOT / "CITATION.cff").read_text()
    assert f"\nversion: {PROJECT['version']}\n" in citation
    assert "\nlicense: Apache-2.0\n" in citation
    assert "Quasi-Static Legged Locomotors as Nonholonomic Systems" in citation


def test_the_licence_is_apache_2_whole_and_of_the_authors():
    licence = (ROOT / "LICENSE").read_text()
    assert "Version 2.0, January 2004" in licence
    assert "END OF TERMS AND CONDITIONS" in licence
    assert re.search(r"Copyright \d{4} the stratawalk authors\n", licence)


def test_the_changelog_tells_of_this_version_and_of_what_is_new():
    headings = re.findall(
        r"^## \[(.+)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE
    )
    assert headings[0] == "Unreleased"
    assert PROJECT["version"] in headings
