"""Who may speak to the viewer: real requests and websockets to a real server."""

import os
import random
import signal
import socket
import subprocess
import sys
import time
from dataclasses import dataclass
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from sim.viewing.access import Access, OwnSocket
from tests.browser import chromium, watch
from tests.sim.viewing.test_browser import shows_a_robot
from tests.sim.viewing.test_netimgui import pasted, pointing, version

SOCKETS = ("/state", "/ui", "/drop")
MODEL = b'<mujoco><worldbody><geom size="1"/></worldbody></mujoco>'


@dataclass(frozen=True)
class Served:
    """A viewer and the address that it printed."""

    process: subprocess.Popen
    page: str

    @property
    def port(self):
        """Where it listens."""
        return urlsplit(self.page).port

    @property
    def token(self):
        """What proves that one has the address."""
        return urlsplit(self.page).query

    @property
    def own(self):
        """The origin of its own page."""
        return f"http://localhost:{self.port}"

    def get(self, path, port=None, **headers):
        """Status, cookie and body of an answer."""
        link = HTTPConnection("127.0.0.1", port or self.port, timeout=20)
        given = {"Host": f"localhost:{port or self.port}"} | headers
        link.request("GET", path, headers=given)
        answer = link.getresponse()
        found = answer.status, answer.headers["Set-Cookie"], answer.read()
        link.close()
        return found

    def open(self, path, port=None, **headers):
        """A websocket to it."""
        at = socket.create_connection(("127.0.0.1", port or self.port))
        uri = f"ws://{headers.pop('host', f'localhost:{port or self.port}')}{path}"
        origin = headers.pop("origin", self.own)
        return connect(uri, sock=at, origin=origin, additional_headers=headers)


BRIEF = """
import sys
from mujoco.studio import ux, viewer_protocol
from mujoco.studio.web import web_server
from sim import start

def begun(window, loop=viewer_protocol.run_viewer_loop):
    ux.reset_config()  # as the menu "View" does
    loop(window)

viewer_protocol.run_viewer_loop = begun
web_server._GRANT_EXPIRY_SEC = 0.5  # for which MuJoCo keeps the place of one that left
sys.exit(start.main())
"""


@pytest.fixture(scope="module")
def served(walked, tmp_path_factory):
    home = tmp_path_factory.mktemp("home")
    (layout := home / ".mujoco.ini").write_text("of MuJoCo's own viewer")
    process = subprocess.Popen(
        [sys.executable, "-c", BRIEF, "view", str(walked), "--no-browser"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | {"HOME": str(home)},
    )  # fmt: skip
    viewer = Served(process, process.stdout.readline().strip())
    with viewer.open(f"/ui?sid=first&{viewer.token}") as interface:  # at once
        interface.send(version())
        assert interface.recv(timeout=20)
    yield viewer
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    assert (process.returncode, said.strip()) == (0, "")  # whatever it was sent
    assert layout.read_text() == "of MuJoCo's own viewer"


@pytest.fixture(scope="module")
def cookie(served):
    status, kept, page = served.get(f"/?{served.token}")
    assert status == 200
    assert b"<canvas" in page
    assert kept.endswith("; Path=/; HttpOnly; SameSite=Strict")
    return kept.partition(";")[0]


TUNNEL = """
import asyncio, sys

async def carry(source, target):
    while part := await source.read(65536):
        target.write(part)
        await target.drain()
    target.close()

async def through(reader, writer):
    far = await asyncio.open_connection("127.0.0.1", int(sys.argv[1]))
    await asyncio.gather(carry(reader, far[1]), carry(far[0], writer))

async def main():
    server = await asyncio.start_server(through, "127.0.0.1", 0)
    print(server.sockets[0].getsockname()[1], flush=True)
    await server.serve_forever()

asyncio.run(main())
"""


@pytest.fixture
def tunnel(served):
    """A port that leads to the viewer's, as `ssh -L` makes one."""
    process = subprocess.Popen(
        [sys.executable, "-c", TUNNEL, str(served.port)],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    yield int(process.stdout.readline())
    process.kill()
    process.wait()
    process.stdout.close()


STRANGERS = {
    "a page of somebody else's": {"origin": "http://evil.example"},
    "a page in a frame": {"origin": "null"},
    "a page of another server here": {"origin": "http://localhost:1"},
    "a name that leads here": {
        "host": "evil.example", "origin": "http://evil.example"
    },
    "a name like one of its own": {
        "host": "localhost.evil.example", "origin": "http://localhost.evil.example"
    },
}  # fmt: skip


@pytest.mark.parametrize("path", SOCKETS)
@pytest.mark.parametrize("stranger", STRANGERS.values(), ids=STRANGERS)
def test_no_socket_is_opened_for_a_stranger(served, cookie, path, stranger):
    """Even with the token."""
    with pytest.raises(InvalidStatus, match="403"):
        served.open(f"{path}?sid=a&{served.token}", Cookie=cookie, **stranger)


@pytest.mark.parametrize("path", ["/", "/model", "/web_client.js", "/nothing"])
def test_no_page_is_given_to_a_stranger(served, cookie, path):
    for headers in ({"Host": "evil.example"}, {"Origin": "http://evil.example"}):
        status, kept, text = served.get(path, Cookie=cookie, **headers)
        assert (status, kept) == (403, None)
        assert len(text) < 80


@pytest.mark.parametrize("path", [*SOCKETS, "/", "/model", "/nothing"])
@pytest.mark.parametrize("wrong", ["", "token=", "token=wrong", "token=%ff", "token"])
def test_without_the_token_nothing_is_answered(served, path, wrong):
    if path in SOCKETS:
        with pytest.raises(InvalidStatus, match="403"):
            served.open(f"{path}?{wrong}", Cookie=wrong)
    status, kept, text = served.get(f"{path}?{wrong}", Cookie=f"a={wrong}")
    assert (status, kept) == (403, None)
    assert text == b"open the address that stratawalk view printed\n"


def test_two_hosts_are_none(served, cookie):
    with socket.create_connection(("127.0.0.1", served.port)) as link:
        hosts = "Host: localhost\r\nHost: evil.example\r\n"
        link.sendall(f"GET / HTTP/1.1\r\n{hosts}Cookie: {cookie}\r\n\r\n".encode())
        assert link.recv(64).startswith(b"HTTP/1.1 403")


def test_the_browser_with_the_address_is_answered(served, cookie):
    with served.open("/state?sid=me", Cookie=cookie) as state:
        assert state.recv(timeout=20).startswith("viewers=")
        assert isinstance(next(m for m in state if not isinstance(m, str)), bytes)
    with served.open("/ui?sid=me", Cookie=cookie) as interface:
        interface.send(version())
        assert len(interface.recv(timeout=20)) == 120  # the same of the viewer
        interface.send(pointing())
        assert interface.recv(timeout=20)  # what is to be drawn


def test_a_tunnel_leads_to_it_by_a_port_of_its_own(served, tunnel):
    status, kept, _ = served.get(f"/?{served.token}", port=tunnel)
    assert status == 200
    there, given = f"http://localhost:{tunnel}", {"Cookie": kept.partition(";")[0]}
    with served.open("/state?sid=far", port=tunnel, origin=there, **given) as state:
        assert state.recv(timeout=20).startswith("viewers=")
    for named in ("127.0.0.1", "[::1]", "LOCALHOST"):
        at = f"{named}:{tunnel}"
        assert served.get("/", port=tunnel, Host=at, **given)[0] == 200


@pytest.mark.full
def test_chromium_shows_the_walk_through_a_tunnel(served, tunnel, tmp_path):
    chromium()
    page = f"http://localhost:{tunnel}/?{served.token}"
    watch(page, tmp_path, shows_a_robot)


def test_nothing_is_loaded_that_is_dropped(served, cookie):
    with pytest.raises(InvalidStatus, match="404"):
        served.open("/drop?sid=me", Cookie=cookie)


def test_every_viewer_has_a_token_of_its_own():
    tokens = {Access(()).token for _ in range(100)}
    assert len(tokens) == 100
    assert min(map(len, tokens)) >= 22  # 128 bits


@pytest.mark.parametrize("path", ["/state", "/ui"])
def test_a_viewer_survives_whatever_a_browser_sends(served, cookie, path):
    dice = random.Random(path)
    words = ["request_control", "force_control", "leave_queue", "heartbeat", "theme=x"]
    words += ["max_spectators=-1", f"max_spectators={'9' * 5000}", "state_ack", "\0"]
    known = [version(), pointing(), pasted(b"text"), MODEL, b"", b"\xff" * 300]
    for number in range(36 if path == "/state" else 20):  # a second for some of /ui
        with served.open(f"{path}?sid={number % 3}", Cookie=cookie) as link:
            try:
                if path == "/ui" and number % 2:
                    link.send(version())
                for _ in range(dice.randrange(1, 8)):
                    message = bytearray(dice.choice(known))
                    for _ in range(dice.choice((0, 1, 5)) if message else 0):
                        message[dice.randrange(len(message))] = dice.randrange(256)
                    link.send(dice.choice([bytes(message), dice.choice(words)]))
                if not number % 10:
                    link.send(bytes(2**20 + 1))  # more than it takes
            except ConnectionClosed:
                pass
            if not number % 7:
                link.socket.close()  # without a word
    assert served.process.poll() is None
    for _ in range(200):  # the place of one that left is kept for a while
        try:
            test_the_browser_with_the_address_is_answered(served, cookie)
            break
        except ConnectionClosed:
            time.sleep(0.1)
    else:
        pytest.fail("it keeps the place of a browser that left")


def test_a_viewer_survives_what_is_no_request(served, cookie):
    dice = random.Random(1)
    long = b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 999
    words = (b"", b"\0" * 99, long, b"\xff\r\n\r\n")
    for word in (*words, *(dice.randbytes(200) for _ in range(20))):
        with socket.create_connection(("127.0.0.1", served.port)) as link:
            link.sendall(word)
    odd = "/%00", "//..//..//etc/hostname", "/assets/../../x", f"/{'a' * 4000}", "/?a=%"
    for path in (*odd, "/model?crc32=x", "/model?size_bytes=-1&offset_bytes=9"):
        assert served.get(path, Cookie=cookie)[0] in (200, 400, 403, 404)
    test_the_browser_with_the_address_is_answered(served, cookie)


def test_the_inner_socket_is_for_this_process_alone():
    """Whoever else found its port would be given what the person types."""
    with OwnSocket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        listener.settimeout(20)
        place = listener.getsockname()
        script = (
            f"import socket; link = socket.create_connection({place})\n"
            "print(flush=True); print(link.recv(1))"
        )
        other = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE)
        other.stdout.readline()  # it is the first in the line
        with socket.create_connection(place) as own, listener.accept()[0] as taken:
            assert other.communicate(timeout=20)[0].strip() == b"b''"  # hung up on
            taken.sendall(b"x")
            assert own.recv(1) == b"x"
