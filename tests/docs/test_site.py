"""The documentation becomes a site without a warning, which needs no network."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from latex2mathml.converter import convert

from tests.browser import ask

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


@pytest.mark.render
def test_brackets_stand_beside_all_rows_of_a_matrix(tmp_path):
    style = (ROOT / "docs" / "_static" / "columns.css").read_text()
    (fonts,) = re.findall(r"math {\s*font-family: (.*), math;", style)
    command = ["fc-list", ":", "family"]
    installed = subprocess.run(command, capture_output=True, text=True, check=True)
    if not set(fonts.replace('"', "").split(", ")) & set(installed.stdout.split("\n")):
        pytest.skip("NO FONT FOR MATHEMATICS on this machine")
    rows = r"0 \\ " * 7
    formula = convert(
        rf"\left[\begin{{matrix}}{rows}\end{{matrix}}\right]", display="block"
    )
    page = tmp_path / "page.html"
    head = f'<!DOCTYPE html><meta charset="utf-8"><style>{style}</style>'
    page.write_text(f"{head}<body>{formula}</body>")
    script = """return ["mo", "mtable"].map(
        (name) => document.querySelector(name).getBoundingClientRect().height)"""
    bracket, matrix = ask(page, script, tmp_path)
    assert matrix > 100
    assert bracket >= 0.9 * matrix  # 0.11 in a font of single signs
