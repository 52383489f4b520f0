"""Walks as C headers for boards that give pulses, packed so that they fit.

A header holds changes as a text of digits to the base of 64: for how many commands a
row holds, a bit for every channel that changes (as many digits as six channels take),
and for each of these its change from -31 to 31 plus 31, or 63 and the pulse itself in
three digits, the lowest first. Before the first row all pulses are 0. A digit takes a
byte in flash and little more in the text, where a number would take three.
"""

import re
from collections.abc import Iterator
from itertools import islice

import numpy as np

from planner import Array
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import ServoTable
from sim.templates import render

LONGEST_RUN = 63  # commands that a row holds
ITSELF = 32  # instead of a change: the pulse follows
BITS, PLACES = 6, (0, 6, 12)  # of a digit, and where three of them are in a pulse
FIRST = ord("#")  # digit 0; all of them can be printed, two after a backslash
LINE = ".{1,80}"  # digits in a line
CALLS = {  # of the board's library, for pulses in counts and in microseconds
    False: "setPWM({}_channel[i], 0, row[i])",
    True: "writeMicroseconds({}_channel[i], row[i])",
}
SIZES = re.compile(r"^#define \w+_(RATE|COMMANDS|JOINTS) (\S+)", re.M)
DIGITS = re.compile(r"^static const char PROGMEM \w+\[\] =\n(.*?)\n;$", re.M | re.S)
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
    packed = pack(counts)  # as strings in C, without trigraphs
    digits = [re.sub(r"[?\\]", r"\\\g<0>", d) for d in re.findall(LINE, packed)]
    text = render(
        "header.h",
        name=name,
        NAME=name.upper(),
        title=in_comment(title),
        assumed=table.assumed,
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
        digits="\n".join(f'"{line}"' for line in digits),
    )
    return f"{text}\n"


def read_header(text: str, table: ServoTable) -> ServoCommands:
    """The commands of such a header for the same servos."""
    packed, channels = DIGITS.search(text), CHANNELS.search(text)
    sizes = dict(SIZES.findall(text)[::-1])  # the first of each: frames have a rate
    if packed is None or channels is None or "RATE" not in sizes:
        raise ValueError("no table of pulses in PROGMEM")
    found = [int(number) for number in channels[1].split(",")]
    if found != [servo.channel for servo in table.channels]:
        raise ValueError(f"channels {found} are not those of the servo table")
    digits = "".join(line[1:-1] for line in packed[1].splitlines())
    digits = re.sub(r"\\(.)", r"\1", digits)
    return table.commands(unpack(digits, int(sizes["JOINTS"])), float(sizes["RATE"]))


def pack(counts: Array) -> str:
    """Rows of counts (K, J) below 65536, as digits."""
    fresh = np.flatnonzero(np.diff(counts, axis=0, prepend=0).any(axis=1))
    starts = np.union1d(fresh, [0])
    held = np.diff(starts, append=len(counts))
    row, packed = np.zeros(counts.shape[1], dtype=int), list[int]()
    for start, count in zip(starts.tolist(), held.tolist(), strict=True):
        steps, row = counts[start] - row, counts[start]
        packed += (min(count, LONGEST_RUN), *_changes(steps, row))
        for more in range(count - LONGEST_RUN, 0, -LONGEST_RUN):
            packed += (min(more, LONGEST_RUN), *_changes(0 * steps, row))
    return "".join(chr(FIRST + digit) for digit in packed)


def _changes(steps: Array, row: Array) -> Iterator[int]:
    for first in range(0, len(steps), BITS):
        some = enumerate((steps[first : first + BITS] != 0).tolist())
        yield sum(changed << bit for bit, changed in some)
    for step, count in zip(steps.tolist(), row.tolist(), strict=True):
        if 0 < abs(step) < ITSELF:
            yield step + ITSELF - 1
        elif step:
            yield 2 * ITSELF - 1
            yield from (count >> place & 2 * ITSELF - 1 for place in PLACES)


def unpack(packed: str, joints: int) -> Array:
    """The counts of such digits, (K, J)."""
    rows, row = [], np.zeros(joints, dtype=int)
    stream = (ord(digit) - FIRST for digit in packed)
    for held in stream:
        mask = [*islice(stream, -(-joints // BITS))]
        row = row.copy()
        for i in (i for i in range(joints) if mask[i // BITS] >> i % BITS & 1):
            step = next(stream) - ITSELF + 1
            if step == ITSELF:
                row[i] = sum(next(stream) << place for place in PLACES)
            else:
                row[i] += step
        rows += [row] * held
    return np.array(rows)


def in_comment(text: str) -> str:
    """A text that is nothing but a comment in C, which it neither ends nor leaves."""
    return "".join(c if c.isprintable() and c not in "\\*?" else "_" for c in text)


def identifier(name: str) -> str:
    """A name in C, of the letters and digits of a name."""
    return "walk_" + re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_").lower()
