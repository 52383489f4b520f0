"""The report of a run, opened in a real browser: verdict, film, drawings, cursor."""

import json
import re
import shutil
from html.parser import HTMLParser

import numpy as np
import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.evaluation.verdict import FAILURES
from sim.folder import RunFolder
from sim.pictures.clock import FRAME_RATE, TITLE, clock
from sim.pictures.file import encoding
from sim.reports.page import NAME, write_report
from sim.run_folder import run, write
from sim.runs.run import read_run
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from sim.simulation import simulate
from tests.browser import ask
from tests.finished_runs import sealed
from tests.walks import COSTLY

SEEN = """
const shown = (e) => e && getComputedStyle(e).display !== "none";
return {
  verdict: document.querySelector(".verdict strong").textContent,
  words: document.querySelector(".verdict").textContent.match(/arrived/gi)?.length,
  film: document.body.dataset.film,
  video: shown(document.querySelector("video")),
  missing: shown(document.getElementById("missing")),
  drawings: document.querySelectorAll("figure .drawing svg").length,
  curves: document.querySelectorAll("figure svg path").length,
  width: document.documentElement.scrollWidth,
  window: innerWidth,
  smallest: Math.min(...[...document.querySelectorAll(".time svg text")].map(
    (e) => e.getBoundingClientRect().height)),
  now: document.getElementById("now").textContent,
};
"""
CLICK = """
const drawing = document.querySelectorAll(".time .drawing")[2];
const [left, top, right, bottom, from, to] = drawing.dataset.box.split(" ").map(Number);
const frame = drawing.getBoundingClientRect();
const x = frame.left + frame.width * (left + right) / 2;
drawing.dispatchEvent(new PointerEvent("pointerdown", {clientX: x, bubbles: true}));
await new Promise((done) => setTimeout(done, 500));
const film = document.querySelector("video");
return {
  time: Number(document.body.dataset.time), middle: (from + to) / 2,
  cursors: [...document.querySelectorAll(".time .cursor")].map((e) => e.style.left),
  film: film.currentTime,
};
"""


@pytest.fixture(scope="module")
def report(walked, tmp_path_factory):
    """The report of a walk that arrived, without a film."""
    folder = tmp_path_factory.mktemp("reports") / "arrived"
    shutil.copytree(walked, folder)
    return write_report(read_run(folder))


def fallen(folder):
    """Make a run folder tell of a robot that lies on its side from half-time on."""
    summary = json.loads((folder / "summary.json").read_text())
    summary |= {"verdict": "fell", "verdict_text": "fell at 7.0 s: the body tilted"}
    with np.load(folder / "trajectory.npz") as file:
        arrays = dict(file)
    half = len(arrays["time"]) // 2
    arrays["achieved_pose"][half:] += (0.2, 0.3, 2.0)
    arrays["achieved_margin"][half:] = -np.inf  # no foot on the ground
    arrays["contact"][half:] = False
    np.savez(folder / "trajectory.npz", **arrays)
    end = arrays["achieved_pose"][-1].tolist()
    summary["achieved"] |= {"min_margin": -0.4, "pose": end}
    sealed(folder, **summary)
    return folder


def test_every_run_folder_holds_its_report(walked):
    page = (walked / NAME).read_text()
    assert page.index("Arrived") < page.index("Over time")
    assert len(page) < 5e6


class Links(HTMLParser):
    """What a page asks for."""

    def __init__(self, page):
        super().__init__()
        self.found = set(re.findall(r"url\(([^)]*)\)", page))
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        """Note the links of an element."""
        links = ("src", "href", "xlink:href", "poster", "data", "action")
        self.found |= {value for name, value in attributes if name in links}


def test_errors_by_phase_stand_below_the_name_of_their_prediction(report):
    """One name over x, y and yaw of each; a line begins them in every row."""
    page = report.read_text()
    table = page[page.index("<h2>The error by phase") : page.index("<h2>Counts")]
    names = re.findall(r'<th class="begins" colspan="3">([^<]*)<', table)
    assert names[:2] == ["ideal", "quasi-static"]
    first, second, *rows = re.findall(r"<tr>.*?</tr>", table, re.DOTALL)
    assert first.count("<th") == 4 + len(names)
    assert second.count("<th") == 4 + 3 * len(names)
    assert {row.count("class=begins") for row in rows} == {len(names)}


def test_the_page_asks_nothing_of_the_network(report):
    page = report.read_text()
    asked = {link for link in Links(page).found if not link.startswith("#")}
    assert asked == {"video.mp4", "data:,"}
    assert "@import" not in page


def test_a_run_that_arrived_is_seen_to(report, tmp_path):
    seen = ask(report, SEEN, tmp_path)
    assert seen["verdict"].startswith("Arrived ")
    assert seen["words"] == 1
    assert (seen["film"], seen["video"], seen["missing"]) == ("missing", False, True)
    assert seen["drawings"] == 8
    assert seen["curves"] > 50
    assert "stratum 12, standing still; margin" in seen["now"]


def test_a_telephone_shows_all_of_the_page_without_scrolling_sideways(report, tmp_path):
    seen = ask(report, SEEN, tmp_path, width=375)
    assert seen["width"] == seen["window"] == 375
    assert seen["smallest"] > 8  # px, with its line's spacing


def test_a_run_that_fell_is_seen_to(folder, tmp_path):
    seen = ask(write_report(read_run(fallen(folder))), SEEN, tmp_path)
    assert seen["verdict"].partition(" ")[0].lower() in FAILURES
    assert seen["drawings"] == 8


def test_the_cursor_moves_all_drawings_and_the_film(report, tmp_path):
    """The film is a dark one of as many pictures as the walk's own would have."""
    folder = shutil.copytree(report.parent, tmp_path / "filmed")
    walk = read_run(folder)
    with encoding(folder / "video.mp4") as append:
        for _ in clock(walk.time, walk.scenario.playback).rows:
            append(np.zeros((64, 64, 3), np.uint8))
    page = folder / NAME  # drawn before there was a film
    seen = ask(page, SEEN, tmp_path)
    assert (seen["film"], seen["video"], seen["missing"]) == ("shown", True, False)
    found = ask(page, CLICK, tmp_path)
    assert found["time"] == pytest.approx(found["middle"], abs=0.01)
    assert len(found["cursors"]) == 5
    # The film shows that moment; a picture of it is a 25th of a second.
    assert 60 * (found["film"] - TITLE) == pytest.approx(
        found["time"], abs=60 / FRAME_RATE
    )


ZOOM = """
const drawing = document.querySelector(".time .drawing");
const box = () => drawing.dataset.box.split(" ").map(Number);
const whole = box();
const [, out, all] = document.querySelectorAll("#zoom button");
const inwards = document.querySelector("#zoom button");
const curve = [...drawing.querySelectorAll("g[clip-path] > path")].at(-1);
const wide = () => curve.getBoundingClientRect().width;
const before = wide();
inwards.click(); inwards.click();
const zoomed = box(), stretched = wide() / before;
const shown = document.querySelector("#zoom span").textContent;
const numbers = [...drawing.querySelectorAll("[id^='matplotlib.axis_1'] text")]
  .filter((text) => text.style.display !== "none");
const at = numbers.map((text) => [
  Number(text.textContent), Number(text.getAttribute("x")) / 518.4]);
all.click();
return {whole, zoomed, stretched, shown, at, back: box(), again: wide() / before};
"""


def test_the_time_axis_can_be_zoomed_in_all_drawings_at_once(report, tmp_path):
    found = ask(report, ZOOM, tmp_path)
    begin, end = found["whole"][4:6]
    start, stop = found["zoomed"][4:6]
    # The page knows times to a millisecond.
    assert stop - start == pytest.approx((end - begin) / 4, abs=2e-3)
    assert found["stretched"] == pytest.approx(4, rel=0.05)
    assert found["shown"] == f"shown: {start:.2f} to {stop:.2f} s"
    left, _, right = found["whole"][:3]
    assert found["at"]  # the numbers on the axis stand at their times
    for time, share in found["at"]:
        place = left + (right - left) * (time - start) / (stop - start)
        assert share == pytest.approx(place, abs=0.004)
    assert found["back"] == pytest.approx(found["whole"], abs=2e-3)
    assert found["again"] == pytest.approx(1, abs=0.01)


def test_show_draws_the_report_again_and_prints_its_path(folder, capsys):
    (folder / NAME).unlink()
    assert main(["show", str(folder), "--no-browser"]) == 0
    assert capsys.readouterr().out == f"{folder.resolve() / NAME}\n"
    assert (folder / NAME).exists()


def test_a_run_without_a_creep_floor_says_nothing_of_it(tmp_path, paged):
    short = Scenario(name="short", segments=1, path=line((0.01, 0.0, 0.0)))
    done = simulate(short, without=COSTLY)
    folder = write(done, tmp_path / "run")
    page = (folder / NAME).read_text()
    assert "Its feet slipped" in page
    assert "Dotted lines are the quasi-static prediction." in page
    assert "creep" not in page
    assert main(["compare", str(folder), str(folder)]) == 0


def test_show_of_what_is_no_run_is_refused(tmp_path, capsys):
    assert main(["show", str(tmp_path)]) == 2
    assert "it lacks scenario.toml" in capsys.readouterr().err
    assert main(["show", str(tmp_path / "nothing")]) == 2
    assert "no such run folder" in capsys.readouterr().err
    with pytest.raises(UsageError):
        write_report(read_run(tmp_path))


@pytest.mark.parametrize("display", [None, ":7"])
def test_a_browser_opens_only_where_there_is_a_display(
    folder, tmp_path, monkeypatch, capsys, display
):
    """A real program in the browser's place notes what it is asked to open."""
    drawn = lambda run, progress: run.folder / NAME  # noqa: E731
    monkeypatch.setattr("sim.reports.page.write_report", drawn)
    noted, browser = tmp_path / "noted", tmp_path / "browser"
    browser.write_text(f'#!/bin/sh\nprintf %s "$1" > {noted}\n')
    browser.chmod(0o755)
    monkeypatch.setenv("BROWSER", str(browser))
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if display:
        monkeypatch.setenv("DISPLAY", display)
    assert main(["show", str(folder)]) == 0
    opened = noted.read_text() if noted.exists() else None
    assert opened == ((folder / NAME).resolve().as_uri() if display else None)


def test_a_report_that_cannot_be_written_leaves_the_run(scenario, tmp_path, paged):
    (tmp_path / NAME).mkdir()
    told = []
    short = scenario(timestep=0.002)
    summary = run(short, RunFolder(tmp_path), warn=told.append, without=COSTLY)
    assert summary["verdict"]
    assert (tmp_path / "summary.json").exists()
    (line,) = told
    assert line.startswith("no report: cannot be written")


def test_names_are_escaped(folder):
    text = (folder / "scenario.toml").read_text()
    told = re.sub(r'description = "[^"]*"', 'description = "<b>&</b>"', text)
    (folder / "scenario.toml").write_text(told)
    page = write_report(read_run(folder)).read_text()
    assert "&lt;b&gt;&amp;&lt;/b&gt;" in page
    assert "<b>&</b>" not in page
