"""The address that `view` prints is one that a browser can open."""

import socket
from unittest.mock import MagicMock
from urllib.parse import urlsplit

import pytest

from sim.viewing import web

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
    web.serve(walked, host, 0, 1.0, pages.append)
    (page,) = map(urlsplit, pages)
    assert page.hostname == NAMES[host].lower()
    assert page.port > 0
