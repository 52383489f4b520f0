"""Browsers that no longer read: a laptop that sleeps, a tab that was stopped."""

import asyncio
import base64

from websockets.asyncio.server import serve

from sim.viewing import access
from sim.viewing.access import _Heard


def test_a_browser_that_reads_nothing_is_dropped_for_others_wait_for_it(monkeypatch):
    """Two real ends of a websocket; the one that stalls has small buffers."""
    monkeypatch.setattr(access, "UNREAD", 0.2)
    ends = []

    async def fill(connection):
        try:
            while True:
                await _Heard(connection).send(bytes(2**16))
        except ConnectionError as error:
            ends.append(str(error))

    async def stalled():
        async with serve(fill, "127.0.0.1", 0) as server:
            place = server.sockets[0].getsockname()
            key = base64.b64encode(bytes(16)).decode()
            head = ["GET / HTTP/1.1", f"Host: {place[0]}", "Upgrade: websocket"]
            head += ["Connection: Upgrade", f"Sec-WebSocket-Key: {key}"]
            reader, writer = await asyncio.open_connection(*place, limit=2**10)
            lines = [*head, "Sec-WebSocket-Version: 13", "", ""]
            writer.write("\r\n".join(lines).encode())
            reader._transport.pause_reading()
            async with asyncio.timeout(20):
                while not ends:
                    await asyncio.sleep(0.05)
            writer.transport.abort()

    asyncio.run(stalled())
    assert ends == ["a browser reads nothing"]
