"""The address that `view` prints is one that a browser can open."""

import os
import signal
import socket
import subprocess
import time
from unittest.mock import MagicMock
from urllib.error import HTTPError
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

import pytest

from sim.viewing import web
from tests.commands import COMMAND

HERE = socket.gethostname()
NAMES = {
    "127.0.0.1": "localhost",
    "::1": "localhost",
    "0.0.0.0": HERE,  # noqa: S104 (nothing answers, no viewer is launched)
    "::": HERE,
    "": HERE,
    "::ffff:127.0.0.1": "::ffff:127.0.0.1",
}


@pytest.mark.physics
@pytest.mark.parametrize("host", NAMES)
def test_a_page_is_at_a_name_of_this_machine(host, walked, monkeypatch):
    if ":" in host and not socket.has_ipv6:
        pytest.skip("this machine has no IPv6")
    pages, viewer = [], MagicMock()
    viewer.is_running.return_value = False

    def launch(walk, model, playback, bound, access, started):
        started()
        bound.close()
        return viewer

    monkeypatch.setattr(web, "_launch", launch)
    web.serve(walked, host, 0, 1.0, lambda *both: pages.extend(both))
    page, once = map(urlsplit, pages)
    assert page[:3] == once[:3]
    assert page.query != once.query
    assert page.hostname == NAMES[host].lower()
    assert page.port > 0


BROWSER = """#!/bin/sh
echo "$1" >address.part
mv address.part address
exec sleep 60
"""


@pytest.mark.physics
def test_other_users_cannot_use_the_address_in_the_command_line_of_a_browser(
    walked, tmp_path
):
    (browser := tmp_path / "browser").write_text(BROWSER)
    browser.chmod(0o755)
    with subprocess.Popen(
        [*COMMAND, "view", walked, "--port", "0", "--browser"],
        cwd=tmp_path, stdout=subprocess.PIPE, text=True,
        env=os.environ | {"BROWSER": f"{browser} %s &"},
    ) as viewer:  # fmt: skip
        printed = viewer.stdout.readline().strip()
        try:
            require_one_use(printed, tmp_path / "address")
        finally:
            viewer.send_signal(signal.SIGINT)
    assert viewer.returncode == 0


def require_one_use(printed, file):
    """Of the address in a file, unlike of the one that is printed."""
    while not file.exists():
        time.sleep(0.1)
    once = file.read_text().strip()
    with urlopen(once) as answer:
        cookie = answer.headers["Set-Cookie"].partition(";")[0]
    assert urlsplit(printed).query not in once
    with pytest.raises(HTTPError, match="403"):
        urlopen(once)
    for again in (Request(once, headers={"Cookie": cookie}), printed):
        with urlopen(again) as answer:
            assert answer.status == 200
