"""Who may speak to the viewer's server: the browser with the address that was printed.

A page of anybody's that is open in a browser can send requests to this machine, and by
a name of its own that leads here read the answers. Every request therefore brings the
token of the printed address, in it or in the cookie that it is answered with; is sent
to this machine by one of its own names; and comes from no page but the viewer's.
"""

from __future__ import annotations

import logging
import os
import socket
from collections.abc import AsyncIterator, Awaitable, Callable, Collection
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus
from secrets import compare_digest, token_hex, token_urlsafe
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs, urlsplit

from sim.viewing.netimgui import Commands

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.datastructures import Headers
    from websockets.http11 import Request, Response

    Answer = Callable[[ServerConnection, Request], Response | None]
    Handler = Callable[[ServerConnection], Awaitable[None]]

LIMITS = {"max_size": 2**20, "open_timeout": 10.0}  # of a message [bytes], [s]
UI, DROP = "/ui", "/drop"  # where a browser says what is done to it, and drops models
POLICY_VIOLATION = 1008  # code that closes a websocket


@dataclass(frozen=True)
class Access:
    """What every request must bring.

    Attributes:
        names: Names of this machine that browsers may call it by; any where there are
            none.
        token: In the printed address.
        cookie: Name of the cookie that keeps the token; other viewers have others.
    """

    names: Collection[str]
    token: str = field(default_factory=partial(token_urlsafe, 16))
    cookie: str = field(default_factory=lambda: f"stratawalk-{token_hex(4)}")

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
        if not any(map(self._is_token, (*given, *_tokens(path)))):
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

        limited = settings | LIMITS
        return serve(heard, process_request=answered, **limited)

    def _is_here(self, host: str) -> bool:
        with suppress(ValueError):  # of brackets that do not match
            return not self.names or urlsplit(f"//{host}").hostname in self.names
        return False

    def _is_token(self, text: str) -> bool:
        return compare_digest(text.encode(errors="replace"), self.token.encode())


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
