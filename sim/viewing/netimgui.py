"""What a browser may say to the viewer's user interface: NetImgui's commands, checked.

The interface is drawn in this process by code in C++ that trusts the lengths, counts
and pointers of what it receives. Commands pass in which all of these are right; others
are a `ValueError`. The layout is that of NetImgui with Dear ImGui 1.92.
"""

from __future__ import annotations

import struct
import time
from collections.abc import Iterator

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
