"""Commands of the viewer's interface: those that a browser sends pass, no others."""

import random
import struct

import numpy as np
import pytest

from sim.viewing.access import CHARACTERS, CLIPBOARD, INPUT, VERSION, Commands

FLOATS = (16, 20, 540, 544, *range(584, 616, 4))  # wheels, scale, rate, sticks


def version():
    """As Chromium sends it."""
    return struct.pack("<IB3x", 120, VERSION) + b"MuJoCo Web Viewer".ljust(112, b"\0")


def pointing(x=10, y=20, count=0, scale=1.0, rate=60.0):
    """The mouse somewhere, as Chromium sends it."""
    state = struct.pack("<2H2h2f", 800, 465, x, y, 0.0, 0.0) + bytes(512)
    state += struct.pack("<H2B2f", count, 1, 0, scale, rate)
    return struct.pack("<IB3x", 616, INPUT) + state.ljust(608, b"\0")


def pasted(text, length=None, begins=9, room=None):
    body = struct.pack("<QQ", len(text) if length is None else length, begins) + text
    body += bytes(-len(body) % 8)
    return struct.pack("<IB3x", room or 8 + len(body), CLIPBOARD) + body


def taken(*messages):
    commands = Commands()
    return [command for message in messages for command in commands.taken(message)]


def test_what_a_browser_sends_passes_unchanged_however_it_is_cut():
    sent = [version(), pointing(), pointing(30, 40, 3)]
    assert taken(*sent) == sent
    whole = b"".join(sent)
    assert taken(*(whole[i : i + 7] for i in range(0, len(whole), 7))) == sent


@pytest.mark.parametrize(
    "messages",
    [
        [pointing()],  # before its version
        [version(), version()],  # a second one
        [struct.pack("<IB3x", 2**31, VERSION)],  # which would be read onto the stack
        [struct.pack("<IB3x", 0, VERSION)],
        [version(), struct.pack("<IB3x", 2**32 - 1, INPUT)],
        [version(), struct.pack("<IB3x", 8, INPUT)],
        [version(), struct.pack("<IB3x", 64, 3)],  # a picture
        [version(), b"\xff" * 64],
        [version(), pointing(count=CHARACTERS + 1)],
        [version(), pointing(scale=0.0)],
        [version(), pointing(scale=1e30)],
        [version(), pointing(rate=float("nan"))],
        [version(), pasted(b"x" * 2**17)],
        [version(), pasted(b"\xff\xfe\0")],
    ],
)
def test_what_no_browser_sends_is_refused(messages):
    with pytest.raises(ValueError, match=r"kind|characters|input|decode"):
        taken(*messages)


def test_no_more_frames_are_asked_for_than_the_browser_draws(monkeypatch):
    """Others would queue up; two quick pictures after a slow one are no pace yet."""
    moments = iter(np.cumsum([0.0, 0.01, 0.8, 0.8, 0.1, 0.1, 0.1, 0.1, 0.01]))
    monkeypatch.setattr("sim.viewing.access.time.monotonic", moments.__next__)
    _, *inputs = taken(version(), *[pointing()] * 8)
    rates = [struct.unpack_from("<f", command, 544)[0] for command in inputs]
    expected = [60, 1 / 0.8, 1 / 0.8, 1 / 0.4, 1 / 0.2, 10, 10, 20]
    np.testing.assert_allclose(rates, expected, rtol=1e-6)


@pytest.mark.parametrize("place", FLOATS)
@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1e30])
def test_every_number_of_an_input_is_checked(place, value):
    spoilt = bytearray(pointing())
    struct.pack_into("<f", spoilt, place, value)
    with pytest.raises(ValueError, match=r"input|scale"):
        taken(version(), bytes(spoilt))


@pytest.mark.parametrize("begins", [9, 1, 2**60 | 1, 2**64 - 1, 0])
def test_a_pasted_text_begins_where_it_does_and_ends(begins):
    """Wherever it says that it begins, and however long it says that it is."""
    text = "1.25 µ".encode()
    _, command = taken(version(), pasted(text, length=2**40, begins=begins))
    assert command == pasted(text + b"\0")


def test_no_bytes_do_anything_but_pass_or_be_refused():
    dice, passed = random.Random(0), 0
    for _ in range(5000):
        commands, known = Commands(), [version(), pointing(), pasted(b"text")]
        for message in known:
            spoilt = bytearray(message)
            for _ in range(dice.choice((0, 0, 1, 3))):
                spoilt[dice.randrange(len(spoilt))] = dice.randrange(256)
            try:
                for command in commands.taken(bytes(spoilt)):
                    length, kind = struct.unpack_from("<IB", command)
                    assert length == len(command)
                    assert kind in (VERSION, INPUT, CLIPBOARD)
                    passed += 1
            except ValueError:
                break
    assert passed > 5000
