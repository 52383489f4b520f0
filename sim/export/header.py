"""Walks as C headers for boards that give pulses, packed so that they fit.

A header holds changes, byte after byte: for how many commands a row holds, a bit for
every channel that changes (as many bytes as eight channels take), and for each of these
its change from -127 to 127, or 128 and the pulse itself in two bytes. Before the first
row all pulses are 0.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice
from textwrap import wrap

import numpy as np

from planner import Array
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import ServoTable
from sim.templates import render

LONGEST_RUN = 255  # commands that a row holds
ITSELF = 128  # instead of a change: the pulse follows
WIDTH = 88  # of a line of bytes
CALLS = {  # of the board's library, for pulses in counts and in microseconds
    False: "setPWM({}_channel[i], 0, row[i])",
    True: "writeMicroseconds({}_channel[i], row[i])",
}
SIZES = re.compile(r"^#define \w+_(RATE|FRAME_RATE|COMMANDS|JOINTS) (\S+)", re.M)
BYTES = re.compile(r"^static const uint8_t PROGMEM \w+\[\d+\] = \{\n([^}]*)\n\};", re.M)
CHANNELS = re.compile(r"^static const uint8_t \w+_channel\[\d+\] = \{(.*?)\};", re.M)


def write_header(
    commands: ServoCommands, table: ServoTable, *, title: str, name: str, file: str
) -> str:
    """A header for PCA9685 boards with a player sketch, its table named after `name`.

    A row is a command and a column a channel; their changes lie in PROGMEM.
    """
    counts, name = table.counts(commands), identifier(name)
    numbers = [str(servo.channel) for servo in table.channels]
    listed = [f"//   {s.channel:2}  {in_comment(s.joint)}" for s in table.channels]
    packed = pack(counts)
    text = render(
        "header.h",
        name=name,
        NAME=name.upper(),
        title=in_comment(title),
        commands=len(counts),
        joints=len(numbers),
        rate=float(commands.rate),
        frame_rate=float(table.frame_rate),
        clock=round(table.clock),
        size=len(packed),
        unit="in microseconds" if table.microseconds else "in counts of 4096 a frame",
        listed="\n".join(listed),
        file=in_comment(file),
        call=CALLS[table.microseconds].format(name),
        channels=", ".join(numbers),
        bytes="\n".join(wrap(", ".join(map(str, packed)), WIDTH)),
    )
    return f"{text}\n"


def read_header(text: str, table: ServoTable) -> ServoCommands:
    """The commands of such a header for the same servos."""
    packed, channels = BYTES.search(text), CHANNELS.search(text)
    sizes = dict(SIZES.findall(text))
    if packed is None or channels is None or "RATE" not in sizes:
        raise ValueError("no table of pulses in PROGMEM")
    found = [int(number) for number in channels[1].split(",")]
    if found != [servo.channel for servo in table.channels]:
        raise ValueError(f"channels {found} are not those of the servo table")
    counts = unpack(bytes(map(int, packed[1].split(","))), int(sizes["JOINTS"]))
    return table.commands(counts, float(sizes["RATE"]))


def pack(counts: Array) -> bytes:
    """Rows of counts (K, J) below 65536, as bytes."""
    fresh = np.flatnonzero(np.diff(counts, axis=0, prepend=0).any(axis=1))
    starts = np.union1d(fresh, [0])
    held = np.diff(starts, append=len(counts))
    row, packed = np.zeros(counts.shape[1], dtype=int), bytearray()
    for start, count in zip(starts.tolist(), held.tolist(), strict=True):
        steps, row = counts[start] - row, counts[start]
        packed += bytes((min(count, LONGEST_RUN), *_changes(steps, row)))
        for more in range(count - LONGEST_RUN, 0, -LONGEST_RUN):
            packed += bytes((min(more, LONGEST_RUN), *_changes(0 * steps, row)))
    return bytes(packed)


def _changes(steps: Array, row: Array) -> Iterator[int]:
    yield from np.packbits(steps != 0, bitorder="little").tolist()
    for step, count in zip(steps.tolist(), row.tolist(), strict=True):
        if 0 < abs(step) < ITSELF:
            yield step % 256
        elif step:
            yield from (ITSELF, count % 256, count // 256)


def unpack(packed: bytes, joints: int) -> Array:
    """The counts of such bytes, (K, J)."""
    rows, row, stream = [], np.zeros(joints, dtype=int), iter(packed)
    for held in stream:
        mask = np.array([*islice(stream, (joints + 7) // 8)], dtype=np.uint8)
        row = row.copy()
        for i in np.flatnonzero(np.unpackbits(mask, bitorder="little")[:joints]):
            step = next(stream)
            if step == ITSELF:
                row[i] = next(stream) + 256 * next(stream)
            else:
                row[i] += step - 256 * (step > ITSELF)
        rows += [row] * held
    return np.array(rows)


def in_comment(text: str) -> str:
    """A text that is nothing but a comment in C, which it neither ends nor leaves."""
    return "".join(c if c.isprintable() and c not in "\\*?" else "_" for c in text)


def identifier(name: str) -> str:
    """A name in C, of the letters and digits of a name."""
    return "walk_" + re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_").lower()
