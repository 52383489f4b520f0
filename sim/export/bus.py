"""Moves servos on a bus, one at a time or by a table; needs pyserial and nothing else.

python bus.py MAKE PORT             then lines such as
  3 512     servo 3 goes to count 512
  j 3 512   servo 3 goes up from count 512 by 20 counts and back, three times
python bus.py MAKE PORT walk.csv 4,7,9   plays a table of counts for these servos
"""

import csv
import sys
import time
from collections.abc import Callable

JOG = 20  # counts
# protocol, baud rate, addresses of torque (where it is to be switched on) and goal
MAKES = {
    "ax-12": (1, 1_000_000, 24, 30),
    "rx-28": (1, 57_600, 24, 30),
    "sts3215": (1, 1_000_000, 40, 42),
    "xl-330": (2, 57_600, 64, 116),
    "lx-16a": (0, 115_200, None, 1),
}


def packets(make: str, servo: int, count: int) -> bytes:
    """What tells a servo to go to a count."""
    protocol, _, torque, goal = MAKES[make]
    size = 4 if protocol != 1 else 2  # those of protocol 0 are a time of two bytes, too
    on = b"" if torque is None else _packet(protocol, servo, torque, b"\1")
    return on + _packet(protocol, servo, goal, count.to_bytes(size, "little"))


def _packet(protocol: int, servo: int, address: int, data: bytes) -> bytes:
    if protocol == 2:
        told = bytes((servo, len(data) + 5, 0, 3)) + _words(address) + data
        told = b"\xff\xff\xfd\x00" + told
        return told + _words(_crc(told))
    write = (3,) if protocol == 1 else ()
    told = bytes((servo, len(data) + 3, *write, address)) + data
    return (b"\xff\xff" if write else b"\x55\x55") + told + bytes((~sum(told) % 256,))


def _words(*values: int) -> bytes:
    return b"".join(value.to_bytes(2, "little") for value in values)


def _crc(told: bytes) -> int:
    crc = 0
    for byte in told:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ (0x8005 if crc & 0x8000 else 0)
    return crc & 0xFFFF


def main() -> None:
    """Open the port, and do what the lines of the terminal or a table say."""
    import serial

    make, port, *table = sys.argv[1:]
    with serial.Serial(port, MAKES[make][1]) as line:

        def go(servo: int, count: int) -> None:
            line.write(packets(make, servo, count))

        if table:
            play(table[0], table[1], go)
            return
        for words in map(str.split, sys.stdin):
            if words[0] != "j":
                go(int(words[0]), int(words[1]))
                continue
            servo, count = map(int, words[1:])
            for _ in range(3):
                for place in (count, count + JOG):
                    go(servo, place)
                    time.sleep(0.5)
            go(servo, count)


def play(table: str, servos: str, go: Callable[[int, int], None]) -> None:
    """Play the rows of a table, a column a servo."""
    with open(table, newline="") as file:
        _, *rows = csv.reader(file)
    begun, numbers = time.monotonic(), [int(number) for number in servos.split(",")]
    for moment, *counts in rows:
        time.sleep(max(begun + float(moment) - time.monotonic(), 0.0))
        for servo, count in zip(numbers, counts, strict=True):
            go(servo, int(count))


if __name__ == "__main__":
    main()
