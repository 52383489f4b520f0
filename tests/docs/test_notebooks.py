"""The notebooks of the documentation run from top to bottom and show what they say."""

import base64
import os
import re
from pathlib import Path

import imageio.v3 as iio
import nbformat
import pytest
from nbclient import NotebookClient

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
    assert names == ["bracket", "cupboard", "hexapod"]
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
