"""Pages opened in a real headless Chromium, which says what it finds there."""

import base64
import io
import json
import re
import shutil
import subprocess
import time
from contextlib import contextmanager
from urllib.parse import unquote
from urllib.request import urlopen

import numpy as np
import pytest
from PIL import Image
from websockets.sync.client import connect

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--virtual-time-budget=8000",
)  # fmt: skip
DRAWING = (  # WebGL without a graphics card
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--window-size=800,640", "--remote-debugging-port=0",
)  # fmt: skip
PATIENCE, PICTURES = 150.0, 30  # [s] and drawn, until something must be seen
COMPLAINTS = re.compile(r"CONSOLE.*?\"(.*)\"")
FRAME = """<!DOCTYPE html><meta charset="utf-8"><body style="margin: 0">
{frames}
<script>
addEventListener("message", (event) => {{
  document.body.append(Object.assign(document.createElement("output"), {{
    textContent: encodeURIComponent(event.data),
  }}));
}});
</script>"""
PART = """<iframe style="border: 0; width: {}px; height: 3000px" src="{}"></iframe>"""
PROBE = """<script>
setTimeout(async () => {{
  let found;
  try {{ found = await (async () => {{ {script} }})(); }}
  catch (error) {{ found = {{error: String(error)}}; }}
  parent.postMessage(JSON.stringify([{number}, found]), "*");
}}, 1500);
</script></body>"""


def chromium():
    """Path of the browser; the test is skipped where there is none."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip("NO CHROMIUM on this machine: the pages were not opened")
    return found


def ask(page, script, scratch, width=1000):
    """What a script returns that runs in a page of a width [px]; JSON values."""
    (found,) = ask_all([page], script, scratch, width)
    return found


def ask_all(pages, script, scratch, width=1000):
    """The same of pages in one folder, which one browser opens together.

    Copies of them with the script lie beside them meanwhile, so that their links hold.
    """
    frame = pages[0].with_name("frame.html")
    copies = [page.with_name(f"asked-{page.name}") for page in pages]
    for number, (page, copy) in enumerate(zip(pages, copies, strict=True)):
        probe = PROBE.format(script=script, number=number)
        copy.write_text(page.read_text().replace("</body>", probe))
    frames = "".join(PART.format(width, copy.name) for copy in copies)
    frame.write_text(FRAME.format(frames=frames))
    done = open_in_browser(frame, scratch, "--dump-dom")
    for file in (frame, *copies):
        file.unlink()
    assert COMPLAINTS.findall(done.stderr) == []
    said = re.findall("<output>(.*?)</output>", done.stdout)
    found = dict(json.loads(unquote(one)) for one in said)
    return [found[number] for number in range(len(pages))]


def open_in_browser(page, scratch, *flags):
    """Open a page with a browser of its own, whose profile lies in a scratch folder."""
    return subprocess.run(
        [
            chromium(), *FLAGS, f"--user-data-dir={scratch / 'profile'}",
            "--enable-logging=stderr", "--window-size=1100,3000", *flags, page.as_uri(),
        ],
        capture_output=True, text=True, check=True, timeout=120,
    )  # fmt: skip


def watch(address, scratch, seen):
    """The first picture of a page that shows what it should; shape (height, width, 3).

    A page with a scene takes long on two cores: it is the picture that is waited for.
    """
    with debugged(address, scratch) as ask_page:
        return wait_for(ask_page, seen, scratch)


def wait_for(ask_page, seen, scratch):
    """The first picture of an open page that shows what it should.

    It comes within some time or, where others load the machine and a picture takes
    five seconds, within some pictures more.
    """
    end, drawn = time.monotonic() + PATIENCE, 0
    while time.monotonic() < end or drawn < PICTURES:
        picture = picture_of(ask_page)
        if seen(picture):
            return picture
        time.sleep(1.0)
        if time.monotonic() > end:
            draws(ask_page, 1)
            drawn += 1
    Image.fromarray(picture.astype(np.uint8)).save(scratch / "last.png")
    raise AssertionError(f"not seen; the last picture is in {scratch}")


def picture_of(ask_page):
    """What an open page shows, shape (height, width, 3)."""
    shot = base64.b64decode(ask_page("Page.captureScreenshot")["data"])
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)


def draws(ask_page, pictures=3):
    """Wait until a page has drawn some more pictures."""
    count = f"let n = {pictures}; const next = () => n-- ? requestAnimationFrame(next)"
    wait = f"new Promise((done) => {{ {count} : done(); next(); }})"
    ask_page("Runtime.evaluate", expression=wait, awaitPromise=True)


def drag(ask_page, start, end):
    """Press the mouse at one place and release it at another, pictures in between."""
    steps = ("mouseMoved", start), ("mousePressed", start), ("mouseMoved", end)
    for kind, (x, y) in (*steps, ("mouseReleased", end)):
        told = {"x": x, "y": y, "button": "left", "clickCount": 1}
        ask_page("Input.dispatchMouseEvent", type=kind, **told)
        draws(ask_page)


@contextmanager
def debugged(address, scratch):
    """A page opened in a browser that answers questions meanwhile."""
    flags = [flag for flag in FLAGS if "virtual-time" not in flag]
    profile = f"--user-data-dir={scratch / 'watched'}"
    process = subprocess.Popen(
        [chromium(), *flags, *DRAWING, profile, address],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        told = next(line for line in process.stderr if "DevTools listening" in line)
        port = re.search(r":(\d+)/", told)[1]
        with urlopen(f"http://127.0.0.1:{port}/json") as answer:
            pages = [page for page in json.load(answer) if page["type"] == "page"]
        with connect(pages[0]["webSocketDebuggerUrl"], max_size=None) as channel:

            def ask_page(method, **params):
                told = {"id": 1, "method": method, "params": params}
                channel.send(json.dumps(told))
                while "result" not in (said := json.loads(channel.recv(timeout=120))):
                    pass
                return said["result"]

            yield ask_page
    finally:
        process.kill()
        process.wait()
        process.stderr.close()
