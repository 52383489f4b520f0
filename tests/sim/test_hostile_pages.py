"""Names that nobody would choose on the pages: they add no element to any."""

import re
from dataclasses import replace

import numpy as np
import pytest

from models.description import is_plain
from sim.cli import main
from sim.reports import comparison, page
from sim.reports.drawing import Drawing
from sim.runs.run import read_run
from sim.sweeps.table import write_table
from sim.templates import render, template
from sim.viewing.replay import _explained
from tests.browser import ask_all
from tests.finished_runs import phase
from tests.hostile import elements, names

NAMES = names(1000)
PLAIN = [name for name in NAMES if is_plain(name)]


def spoilt(run):
    """A run in which every name is one of the thousand."""
    mean = "".join(name for name in NAMES if "\ud800" not in name)
    summary = replace(run.summary, scenario=mean, robot=mean, stance=mean)
    return replace(
        run,
        settings={**run.settings, "description": mean},
        card_text=f"{run.card_text}\n# {''.join(PLAIN)}",
        summary=summary,
        phases=(*run.phases, phase("swing", "<b>", "<i>")),
    )


@pytest.fixture(scope="module")
def pages(walked):
    """Pages of a run and of the same with other names."""
    run = read_run(walked)
    return {
        name: [make(run), make(spoilt(run))]
        for name, make in (
            ("report", page.page),
            ("compare", lambda run: comparison.page(comparison.compare([run, run]))),
        )
    }


def test_names_add_no_element_to_a_page(pages):
    for plain, hostile in pages.values():
        known = set(elements(plain))
        added = set(elements(hostile)) - known
        assert added == set()


def test_names_add_no_element_to_a_replay(walked):
    run = read_run(walked)
    shell = "<html><title></title><body></body></html>"
    name = "".join(PLAIN).replace("/", "").lstrip(".-")
    mean = replace(run, settings={**run.settings, "name": name})
    plain, hostile = (elements(_explained(shell, one, 1.0)) for one in (run, mean))
    assert plain == hostile


def test_names_add_no_element_to_the_page_of_a_calibration():
    def page(joints):
        axis = np.array([0.0, 0.0, -1.0])
        rows = [(joint, 30.0, 60.0, axis, axis) for joint in joints]
        return render("calibration.html", title=f"of {joints[0]}", rows=rows)

    plain, hostile = page(["swing"] * len(PLAIN)), page(PLAIN)
    added = set(elements(hostile)) - set(elements(plain))
    assert added <= {("wbr", 0)}
    pictures = re.findall('src="([^"]*)"', hostile)
    assert pictures == [f"joint-{number}.png" for number, _ in enumerate(PLAIN, 1)]


@pytest.fixture
def studied(tmp_path):
    """The page of a table whose settings, texts and verdicts have given names."""

    def make(key, texts):
        rows = [
            {
                "point": number, key: text, "friction": 0.1 * (number % 2),
                "status": "ok", "verdict": "arrived", "path_length": 0.1,
                "distance_walked": 1.0, "error.quasi_static.farthest": 0.001 * number,
            }
            for number, text in enumerate(texts)
        ]  # fmt: skip
        asked = {"vary": {key: [], "friction": []}, "scenario": {"name": texts[0]}}
        about = {"asked": asked | {"set": {texts[1]: texts[2]}}, "software": {}}
        write_table(tmp_path / "table.parquet", rows, about)
        page = tmp_path / "study.html"
        page.unlink(missing_ok=True)
        assert main(["study", str(tmp_path / "table.parquet"), "--out", str(page)]) == 0
        return page.read_text()

    return make


def test_names_add_no_element_to_the_page_of_a_study(studied):
    texts = [name for name in NAMES if "\ud800" not in name][:40]
    plain = studied("robot", [f"robot_{number}" for number in range(len(texts))])
    hostile = studied("robot", [*texts, "$\\nosuch$", "$x_{$"])
    added = set(elements(hostile)) - set(elements(plain))
    assert added <= {("text", 2), ("wbr", 0)}  # other ways to place a label


@pytest.mark.parametrize(
    "key", ["<script>alert(1)", 'x"><img src=q onerror="alert(1)">', "k" * 61, "a/b"]
)
def test_what_no_setting_is_called_varies_in_no_table(studied, key, capsys):
    with pytest.raises(AssertionError):
        studied(key, ["a", "b", "c"])
    assert f"it does not say what varies, {key}" in capsys.readouterr().err


def test_headings_add_no_element_to_a_drawing():
    def drawn(heading):
        macro = template("parts.html").module.drawing
        return elements(macro(Drawing("<svg></svg>", heading, [])))

    image = 'x"><img src=q onerror="alert(1)">'
    assert drawn(image) == drawn("plain")


def test_statuses_add_no_element_to_the_page_of_a_study(tmp_path):
    asked = {"vary": {"friction": []}, "scenario": {"name": "line"}, "set": {}}
    done = {"verdict": "arrived", "path_length": 0.1, "distance_walked": 1.0}
    done |= {"status": "ok", "error.quasi_static.farthest": 0.001}
    table, page, pages = tmp_path / "table.parquet", tmp_path / "study.html", []
    for status in ("no plan: none", "no plan: <script>alert(1)</script><b x=1>"):
        rows = [{"point": n, "friction": n / 2} | done for n in range(3)]
        rows.append({"point": 3, "friction": 2.0, "status": status})
        write_table(table, rows, {"asked": asked, "software": {}})
        assert main(["study", str(table), "--out", str(page)]) == 0
        pages.append(elements(page.read_text()))
        page.unlink()
    assert not set(pages[1]) - set(pages[0])


def test_chromium_finds_no_new_element(pages, tmp_path):
    script = """
      window.alert = () => { document.title = "INJECTED"; };
      const count = {};
      for (const element of document.querySelectorAll("*"))
        for (const key of [element.localName, ...element.getAttributeNames()])
          count[key] = 1;
      return [Object.keys(count).sort(), document.scripts.length, document.title];"""
    files = []
    for name, texts in pages.items():
        for number, text in enumerate(texts):
            files.append(tmp_path / f"{name}{number}.html")
            files[-1].write_text(text, errors="replace")
    found = ask_all(files, script, tmp_path)
    for (kinds, scripts, _), (more, as_many, title) in zip(
        found[::2], found[1::2], strict=True
    ):
        assert set(more) <= {*kinds, "wbr"}
        assert as_many == scripts
        assert "INJECTED" not in title
