"""Pages opened in a real headless Chromium, which says what it finds there."""

import json
import re
import shutil
import subprocess
from urllib.parse import unquote

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--virtual-time-budget=8000",
)  # fmt: skip
COMPLAINTS = re.compile(r"CONSOLE.*?\"(.*)\"")
FRAME = """<!DOCTYPE html><meta charset="utf-8"><body style="margin: 0">
<iframe style="border: 0; width: {width}px; height: 3000px" src="{page}"></iframe>
<script>
addEventListener("message", (event) => {{
  document.body.append(Object.assign(document.createElement("output"), {{
    textContent: encodeURIComponent(event.data),
  }}));
}});
</script>"""
PROBE = """<script>
setTimeout(async () => {{
  let found;
  try {{ found = await (async () => {{ {script} }})(); }}
  catch (error) {{ found = {{error: String(error)}}; }}
  parent.postMessage(JSON.stringify(found), "*");
}}, 1500);
</script></body>"""


def chromium():
    """Path of the browser; the test is skipped where there is none."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip("NO CHROMIUM on this machine: the pages were not opened")
    return found


def ask(page, script, scratch, width=1000):
    """What a script returns that runs in a page of a width [px]; JSON values.

    A copy of the page with the script lies beside it meanwhile, so that its links hold.
    """
    copy, frame = page.with_name("asked.html"), page.with_name("frame.html")
    probe = PROBE.format(script=script)
    copy.write_text(page.read_text().replace("</body>", probe))
    frame.write_text(FRAME.format(width=width, page=copy.name))
    done = open_in_browser(frame, scratch, "--dump-dom")
    copy.unlink()
    frame.unlink()
    assert COMPLAINTS.findall(done.stderr) == []
    (said,) = re.findall("<output>(.*?)</output>", done.stdout)
    return json.loads(unquote(said))


def open_in_browser(page, scratch, *flags):
    """Open a page with a browser of its own, whose profile lies in a scratch folder."""
    return subprocess.run(
        [
            chromium(), *FLAGS, f"--user-data-dir={scratch / 'profile'}",
            "--enable-logging=stderr", "--window-size=1100,3000", *flags, page.as_uri(),
        ],
        capture_output=True, text=True, check=True, timeout=120,
    )  # fmt: skip
