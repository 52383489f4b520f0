"""Who may speak to the viewer's server, and what: the browser with the printed address.

Any page in a browser can send requests here, and read the answers by a name of its own
that leads here. Every request therefore brings the token of the printed address, in it
or in a cookie; is sent to this machine by one of its own names; and comes from no page
but the viewer's. The interface is drawn by code in C++ that trusts lengths, counts and
pointers: commands in which these are wrong are a `ValueError`. The layout is that of
NetImgui with Dear ImGui 1.92.
"""

from __future__ import annotations

import asyncio
import logging
import os
import socket
import struct
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Collection, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus
from secrets import compare_digest, token_hex, token_urlsafe
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs, urlsplit

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.datastructures import Headers
    from websockets.http11 import Request, Response

    Answer = Callable[[ServerConnection, Request], Response | None]
    Handler = Callable[[ServerConnection], Awaitable[None]]

HEADER = struct.Struct("<IB3x")  # length of the whole command in bytes, and its kind
VERSION, INPUT, CLIPBOARD = 0, 2, 5
LENGTHS = {VERSION: (120, 120), INPUT: (616, 616), CLIPBOARD: (32, 2**16)}
# Size of the page, mouse, wheels, characters and how many, two flags, scale of fonts,
# pictures a second, masks of keys and buttons, sticks.
STATE = struct.Struct("<2H2h2f512xH2x2f4x32x8f")
CHARACTERS = 256  # at most in a command
PASTED = struct.Struct("<QQ")  # length of a text, and where it begins
BEGINS = 8 | 1  # right behind; the lowest bit marks a distance
RATE = struct.Struct("<f"), 544  # pictures a second, and where they stand in an input
EASED = 0.5  # of an earlier pause between inputs that later ones count at least
SCALES = (0.25, 8.0)  # of fonts, which are drawn anew for each
MOST = 1e4  # turns of a wheel, pictures a second, position of a stick


class Commands:
    """The commands in the bytes that one browser sends, its version first.

    A browser sends an input with every picture that it draws, and asks for 60 frames of
    the interface a second however few it draws. Frames it has no time for would queue
    up, and what is clicked be seen seconds later, so it is sent one a picture.
    """

    def __init__(self) -> None:
        self._rest, self._kinds = b"", {VERSION}
        self._heard, self._pause = time.monotonic(), 0.0

    def taken(self, received: str | bytes) -> Iterator[bytes]:
        """The commands that further bytes complete."""
        if isinstance(received, str):
            raise ValueError("text is no command")
        self._rest += received
        while len(self._rest) >= HEADER.size:
            length, kind = HEADER.unpack_from(self._rest)
            if kind not in self._kinds:
                raise ValueError(f"no command of kind {kind} is taken now")
            least, most = LENGTHS[kind]
            if not least <= length <= most:
                raise ValueError(f"a command of kind {kind} has no {length} bytes")
            if len(self._rest) < length:
                return
            command, self._rest = self._rest[:length], self._rest[length:]
            self._kinds = {INPUT, CLIPBOARD}
            if kind == INPUT:
                command = self._paced(_checked(command))
            yield _pasted(command) if kind == CLIPBOARD else command

    def _paced(self, command: bytes) -> bytes:
        """An input that asks for no more frames a second than inputs come."""
        now, (form, place) = time.monotonic(), RATE
        self._pause = max(now - self._heard, EASED * self._pause)
        self._heard = now
        (rate,) = form.unpack_from(command, place)
        if rate * self._pause > 1:
            rate = 1 / self._pause
        return command[:place] + form.pack(rate) + command[place + form.size :]


def _checked(command: bytes) -> bytes:
    values = STATE.unpack_from(command, HEADER.size)
    *_, across, along, count, scale, rate = values[:9]
    if count > CHARACTERS or not SCALES[0] <= scale <= SCALES[1]:
        raise ValueError(f"{count} characters, fonts of scale {scale}")
    for value in (across, along, rate, *values[9:]):
        if not abs(value) <= MOST:  # nor NaN
            raise ValueError(f"an input of {value}")
    return command


def _pasted(command: bytes) -> bytes:
    """The text of a clipboard, ended, in a command of our own."""
    start = HEADER.size + PASTED.size
    text = command[start:].partition(b"\0")[0].decode().encode() + b"\0"
    room = start + -(-len(text) // 8) * 8
    head = HEADER.pack(room, CLIPBOARD) + PASTED.pack(len(text), BEGINS)
    return (head + text).ljust(room, b"\0")


UNREAD = 5.0  # [s], after which a browser that reads nothing is dropped
LIMITS = {"max_size": 2**20, "open_timeout": 10.0, "close_timeout": UNREAD}
UI, DROP = "/ui", "/drop"  # where a browser says what is done to it, and drops models
POLICY_VIOLATION = 1008  # code that closes a websocket


@dataclass(frozen=True)
class Access:
    """What every request must bring; the token is kept in a cookie of this viewer."""

    names: Collection[str]  # that browsers may call this machine by; any if none
    token: str = field(default_factory=partial(token_urlsafe, 16))  # in the address
    cookie: str = field(default_factory=lambda: f"stratawalk-{token_hex(4)}")

    # what opens the page once, for the command line of a browser, which others can read
    tickets: set[str] = field(default_factory=lambda: {token_urlsafe(16)})

    def refusal(self, headers: Headers, path: str) -> str:
        """Why a request is not answered; empty if it is."""
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        if len(hosts) != 1 or not self._is_here(hosts[0]):
            return "this machine has another name"
        if not {*origins} <= {f"http://{hosts[0]}", f"https://{hosts[0]}"}:
            return "another page asks"
        given = [
            pair.strip().removeprefix(f"{self.cookie}=")
            for line in headers.get_all("Cookie")
            for pair in line.split(";")
        ]
        token, given = self.token.encode(), [*given, *_tokens(path)]
        used = self.tickets.intersection(given)
        self.tickets.difference_update(used)
        known = (compare_digest(t.encode(errors="replace"), token) for t in given)
        if not (used or any(known)):
            return "open the address that stratawalk view printed"
        return ""

    def serve(
        self, handler: Handler, *, process_request: Answer, **settings: Any
    ) -> serve:
        """A server of websockets that answers nobody else, for MuJoCo's to be."""
        from websockets.asyncio.server import serve

        def answered(connection: ServerConnection, request: Request) -> Response | None:
            if why := self.refusal(request.headers, request.path):
                return connection.respond(HTTPStatus.FORBIDDEN, f"{why}\n")
            if urlsplit(request.path).path == DROP:
                return connection.respond(HTTPStatus.NOT_FOUND, "nothing is loaded\n")
            response = process_request(connection, request)
            if response is not None and _tokens(request.path):
                kept = f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Strict"
                response.headers["Set-Cookie"] = kept
            return response

        async def heard(connection: ServerConnection) -> None:
            try:
                await handler(_Heard(connection))  # type: ignore[arg-type]
            except Exception as error:  # which ends what one browser says, no more
                logging.getLogger("WebServer").debug("a browser said: %s", error)

        return serve(heard, process_request=answered, **settings | LIMITS)

    def _is_here(self, host: str) -> bool:
        with suppress(ValueError):  # of brackets that do not match
            return not self.names or urlsplit(f"//{host}").hostname in self.names
        return False


def _tokens(path: str) -> list[str]:
    with suppress(ValueError):
        return parse_qs(urlsplit(path).query).get("token", [])
    return []


class _Heard:
    """A connection that is closed where a browser sends the interface no command."""

    def __init__(self, connection: ServerConnection) -> None:
        self._connection, self._commands = connection, Commands()
        path = connection.request.path if connection.request else ""
        self._is_ui = urlsplit(path).path == UI

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)

    async def send(self, message: str | bytes) -> None:
        """Send in a few seconds or never: other browsers wait for it to be read."""
        try:
            await asyncio.wait_for(self._connection.send(message), UNREAD)
        except TimeoutError:
            self._connection.transport.abort()
            raise ConnectionError("a browser reads nothing") from None

    async def recv(self) -> str | bytes:
        async for message in self:
            return message
        raise ConnectionError("closed before its first message")

    async def __aiter__(self) -> AsyncIterator[str | bytes]:
        async for message in self._connection:
            if not self._is_ui:
                yield message
                continue
            try:
                for command in self._commands.taken(message):
                    yield command
            except ValueError as error:
                await self._connection.close(POLICY_VIOLATION, str(error)[:100])
                return


class OwnSocket(socket.socket):
    """A listening socket to which this process alone may connect."""

    def accept(self) -> tuple[socket.socket, Any]:
        """As of any socket; connections of others are closed."""
        while True:
            connection, peer = super().accept()
            if peer in _own_addresses():
                return connection, peer
            connection.close()


def _own_addresses() -> set[Any]:
    """Addresses of all sockets that this process has."""
    addresses = set()
    for number in os.listdir("/dev/fd"):
        with suppress(OSError):  # of what is no socket
            own = socket.socket(fileno=int(number))
            addresses.add(own.getsockname())
            own.detach()
    return addresses
