"""The documentation becomes a site without a warning, which needs no network."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FETCHED = r"<(?:script|link|img|iframe)[^>]*(?:src|href)=\"(https?:[^\"]+)\""


def build(folder, *options):
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", *options]
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    return subprocess.run(
        [
            *command,
            "-d",
            str(folder / "trees"),
            str(ROOT / "docs"),
            str(folder / "site"),
        ],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )


def judge(folder, done):
    assert done.returncode == 0, done.stderr
    pages = {p.name: p.read_text() for p in (folder / "site").rglob("*.html")}
    fetched = {name: re.findall(FETCHED, text) for name, text in pages.items()}
    assert {name: urls for name, urls in fetched.items() if urls} == {}
    return pages


@pytest.mark.full
def test_pages_become_a_site_without_a_warning(tmp_path):
    done = build(tmp_path, "-D", "nb_execution_mode=off")
    pages = judge(tmp_path, done)
    assert 'id="planner.hall_basis"' in pages["planner.html"]
    assert 'id="models.equations"' in pages["models.html"]
    assert 'id="sim.simulate"' in pages["sim.html"]
    assert "<math" in pages["method.html"]
    assert "$$" not in pages["method.html"]
    stretching = '<mo stretchy="true" fence="true" form="prefix">('
    assert stretching in pages["method.html"].replace("&#x00028;", "(")


@pytest.mark.full
@pytest.mark.physics
@pytest.mark.render
@pytest.mark.usefixtures("driver")
def test_the_whole_site_shows_notebooks_with_their_results(tmp_path):
    done = build(tmp_path, "-D", f"nb_execution_cache_path={tmp_path / 'cache'}")
    pages = judge(tmp_path, done)
    assert "data:video/mp4;base64," in pages["hexapod.html"]
    assert "<math" in pages["bracket.html"]
    assert "controllable by closure" in pages["cupboard.html"]
