"""The notebooks of the documentation run from top to bottom and show what they say."""

import base64
import os
import re
from pathlib import Path

import imageio.v3 as iio
import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

from models import equations, load, shipped_system
from planner import Flow, play
from tests.browser import ask

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "docs" / "notebooks"
LIMIT = 600  # [s] a cell


@pytest.fixture
def outputs(tmp_path, tmp_path_factory, monkeypatch):
    """Run a notebook in an empty folder; all texts that it prints, and its pictures."""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    monkeypatch.setenv("PYTHONPATH", path)
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path_factory.mktemp("ipython")))
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path_factory.mktemp("matplotlib")))
    monkeypatch.setenv("PYDEVD_DISABLE_FILE_VALIDATION", "1")  # no notice on stderr

    def run(name):
        notebook = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
        folder = {"metadata": {"path": str(tmp_path)}}
        NotebookClient(notebook, timeout=LIMIT, resources=folder).execute()
        shown = [
            output
            for cell in notebook.cells
            if cell.cell_type == "code"
            for output in cell.outputs
        ]
        assert [o.text for o in shown if o.get("name") == "stderr"] == []
        assert list(tmp_path.iterdir()) == []
        texts = "".join(o.text for o in shown if o.output_type == "stream")
        return texts, [o.data for o in shown if "data" in o]

    return run


def test_every_notebook_is_run_below_and_kept_without_outputs():
    names = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))
    assert names == ["bracket", "cupboard", "hands-on", "hexapod", "panels"]
    for name in names:
        notebook = nbformat.read(NOTEBOOKS / f"{name}.ipynb", as_version=4)
        code = [cell for cell in notebook.cells if cell.cell_type == "code"]
        assert [c.outputs for c in code if c.outputs] == []


@pytest.mark.full
def test_a_bracket_in_three_lines(outputs):
    texts, shown = outputs("bracket")
    assert "- \\cos{\\left(\\theta \\right)}" in shown[0]["text/latex"]
    assert re.search(r"0\.01 \[ 0\.005 +-1\. ", texts)  # the loop nears the bracket
    assert sum("image/png" in data for data in shown) == 3


HANDS_ON = """
const loop = [0.4, 0.4, 0.2, 0.2];
sliders[0].value = 30;
sliders[0].dispatchEvent(new Event("input"));
return {
  hexapod: endpoint("hexapod", loop), unicycle: endpoint("unicycle", loop),
  said: [...document.querySelectorAll(".two output")].map((e) => e.textContent),
  width: document.querySelector("label output").textContent,
};
"""


@pytest.mark.full
def test_a_loop_by_hand_moves_as_the_planner_says(outputs):
    texts, shown = outputs("hands-on")
    assert "0.042336*cos(0.56*phi_1 - 0.56*phi_2)" in texts
    assert any("iframe" in data.get("text/html", "") for data in shown)


def test_the_page_without_a_server_computes_what_the_planner_does(tmp_path):
    """A loop whose first corner is the origin, by the page's script and by flows."""
    page = tmp_path / "hands-on.html"
    page.write_text((ROOT / "docs" / "_static" / page.name).read_text())
    found = ask(page, HANDS_ON, tmp_path)
    side, hexapod = 0.4, equations(load("hexapod")).system
    unicycle = shipped_system("unicycle").system
    for system, (one, other) in (
        (hexapod, (("1", "g1_1"), ("2", "g2_2"))),
        (unicycle, ((unicycle.bottom, "turn"), (unicycle.bottom, "drive"))),
    ):
        loop = [Flow(*way, t) for t in (side, -side) for way in (one, other)]
        end = play(system, loop, np.zeros(len(system.state)))[-1, :3]
        name = "hexapod" if system is hexapod else "unicycle"
        np.testing.assert_allclose(found[name], end, atol=1e-9)  # the planner's
    assert all("sideways; bracket times area" in said for said in found["said"])
    assert (
        found["width"] == "unicycle 0.9 rad, hexapod 0.27 rad"
    )  # 30 % of twice the ranges


@pytest.mark.full
def test_a_system_of_ones_own(outputs):
    texts, shown = outputs("cupboard")
    assert "is controllable by closure: filtration 4, closure 5 of 5" in texts
    assert float(re.findall(r"(\S+) from the goal", texts)[-1]) < 1e-9
    off = [float(x) for x in re.findall(r"up to ([\d.]+) m", texts)]
    assert off == sorted(off, reverse=True)


@pytest.mark.full
@pytest.mark.physics
@pytest.mark.render
@pytest.mark.usefixtures("driver")
def test_the_hexapod_walks_sideways_and_is_filmed(outputs, tmp_path):
    texts, shown = outputs("hexapod")
    assert "is controllable by" in texts
    x, y = re.search(r"^achieved +([-\d.]+) +([-\d.]+)", texts, re.MULTILINE).groups()
    assert float(y) == pytest.approx(0.02, abs=0.0005)  # 0.02 measured
    assert float(x) == pytest.approx(0.0, abs=0.0005)
    (film,) = re.findall(r"data:video/mp4;base64,([^\"]+)", shown[-1]["text/html"])
    (tmp_path / "film.mp4").write_bytes(base64.b64decode(film))
    assert iio.improps(tmp_path / "film.mp4").shape[0] > 30


@pytest.mark.full
def test_panels_beside_brackets(outputs):
    texts, shown = outputs("panels")
    bracket, panel, played = np.array(texts.split("0.8 ")[1].split()[:3], dtype=float)
    assert panel == played  # Green's theorem, to the digits that are printed
    assert bracket == pytest.approx(played, rel=0.02)  # of the leading order alone
    assert sum("image/png" in data for data in shown) == 2
    for law in ("viscous", "Coulomb"):
        assert f"{law}  -0." in texts
