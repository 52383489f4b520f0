"""The viewer and the replay, opened in a real headless Chromium."""

import re
import signal
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.viewing.replay import write_replay
from sim.viewing.web import require_loopback
from tests.browser import chromium, debugged, drag, draws, wait_for, watch

RED, BLUE = np.array([204, 69, 61]), np.array([41, 112, 191])  # the two tripods


def shows_a_robot(picture):
    """Whether legs of both colours are in the picture, whatever the light."""
    scene = picture[:, 200:] if picture.shape[1] > 400 else picture
    red, green, blue = np.moveaxis(scene, -1, 0)
    reddish = (red > 1.5 * green) & (red > 1.5 * blue) & (red > 90)
    blueish = (blue > 1.4 * red) & (blue > 90)
    return reddish.sum() > 60 and blueish.sum() > 60


# On a page of 800 pixels: the panel's slider and button, and what is free of panels.
SLIDER, BUTTON = np.s_[92:114, 337:488], (355, 129)
SCENE = np.s_[180:420, 215:325]


@pytest.fixture
def served(walked):
    chromium()
    slow = ("--speed", "0.1")  # a busy machine would find the walk at its end
    process = subprocess.Popen(
        [sys.executable, "-m", "sim.cli", "view", str(walked), "--no-browser", *slow],
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        yield process, process.stdout.readline().strip()
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


@pytest.mark.full
def test_the_viewer_shows_the_walk_and_obeys_button_slider_and_drag(served, tmp_path):
    """To this machine alone. What is clicked is seen within a few pictures."""
    process, address = served

    def differs(part, other):
        return lambda picture: (picture[part] != other[part]).any(axis=-1).sum() > 20

    def rests():
        """Nothing changes from one picture to the fourth after it."""
        seen = []

        def same(picture):
            seen.append(picture)
            draws(ask_page, 4)
            return len(seen) > 1 and not differs(SLIDER, seen[-2])(picture)

        return same

    with debugged(address, tmp_path) as ask_page:
        first = wait_for(ask_page, shows_a_robot, tmp_path)
        wait_for(ask_page, differs(SLIDER, first), tmp_path)  # it plays
        drag(ask_page, BUTTON, BUTTON)
        still = wait_for(ask_page, rests(), tmp_path)  # it pauses
        drag(ask_page, (400, 103), (440, 103))
        wait_for(ask_page, differs(SLIDER, still), tmp_path)
        slid = wait_for(ask_page, rests(), tmp_path)
        drag(ask_page, (270, 250), (300, 330))  # the camera turns
        turned = wait_for(ask_page, differs(SCENE, slid), tmp_path)
        drag(ask_page, BUTTON, BUTTON)
        wait_for(ask_page, differs(SLIDER, turned), tmp_path)  # it plays

    port = int(re.fullmatch(r"http://localhost:(\d+)/\?token=[\w-]{22}", address)[1])
    tables = (Path(f"/proc/net/{name}").read_text() for name in ("tcp", "tcp6"))
    rows = (line.split() for table in tables for line in table.splitlines()[1:])
    listening = [
        row[1] for row in rows if row[3] == "0A" and row[1].endswith(f":{port:04X}")
    ]
    assert listening == [f"0100007F:{port:04X}"]  # 127.0.0.1
    process.send_signal(signal.SIGINT)
    assert process.wait(30) == 0


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.2"])
def test_others_may_connect_only_if_that_is_wanted(host, walked):
    with pytest.raises(UsageError, match="nothing is encrypted"):
        require_loopback(host, public=False)
    require_loopback(host, public=True)
    assert main(["view", str(walked), "--host", host]) == 2


def test_a_port_that_is_taken_is_refused_in_a_line(walked, capsys):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["view", str(walked), "--port", str(port), "--no-browser"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"stratawalk: error: cannot listen: 127.0.0.1:{port};")


@pytest.mark.parametrize("option", [["--port", "70000"], ["--speed", "0"]])
def test_numbers_that_are_none_are_refused(walked, option):
    assert main(["view", str(walked), *option]) == 2


def test_a_replay_is_one_file_that_asks_nothing_of_the_network(folder, tmp_path):
    pytest.importorskip("viser")
    told = []
    page = write_replay(folder, told.append)
    assert page == folder / "replay.html"
    assert told == sorted(told)
    assert told[-1] == 1.0
    text = page.read_text()
    assert page.stat().st_size < 5e6
    assert set(re.findall(r"https?://[\w./-]+", text)) <= {"http://www.w3.org/2000/svg"}
    assert "<title>short, a replay</title>" in text
    assert "<summary>short; 1x is 60 times as fast as the robot</summary>" in text
    assert text.count("their footprints are paler</div>") == 2
    watch(page.as_uri(), tmp_path, shows_a_robot)


def test_a_replay_without_its_extra_says_what_to_install(walked, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "viser", None)
    assert main(["view", str(walked), "--replay"]) == 2
    assert "scripts/setup installs all extras" in capsys.readouterr().err
