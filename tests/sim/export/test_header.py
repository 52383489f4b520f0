"""Headers of pulses: small, unpacked as they were packed, and built and run in C."""

import shutil
import subprocess

import numpy as np
import pytest

from models.description.servos import JointServo
from sim.export.header import pack, read_header, unpack, write_header
from sim.export.servo_commands import ServoCommands, taken
from tests.sim.export.test_source import JOINTS, MIRRORED, TITLE, table


@pytest.fixture
def commands():
    angles = np.random.default_rng(3).uniform(-0.8, 0.8, (200, len(JOINTS)))
    return ServoCommands(JOINTS, 60.0, angles)


def walking():
    """Counts such as of a walk: small steps, rests, and a few great leaps."""
    draw, shape = np.random.default_rng(4), (6000, len(JOINTS))
    steps = draw.integers(-9, 10, shape)
    steps[draw.random(shape) < 0.5] = 0
    steps[1000:1500] = 0  # longer than a digit counts
    leaps = draw.integers(0, 6000, 200), draw.integers(0, len(JOINTS), 200)
    steps[leaps] += 60 * draw.choice((-1, 1), 200)
    return 1000 + np.cumsum(steps, axis=0) % 2000


MAIN = """
#include <stdio.h>
#include <stdint.h>
#include "line.h"
int main(void) {
  for (int i = 0; i < WALK_LINE_JOINTS; i++) printf("%d ", walk_line_channel[i]);
  uint16_t row[WALK_LINE_JOINTS] = {0};
  for (int held = walk_line_next(row); held; held = walk_line_next(row))
    for (; held; held--)
      for (int i = 0; i < WALK_LINE_JOINTS; i++) printf("%d ", row[i]);
  printf("%g", WALK_LINE_RATE);
  return 0;
}
"""


def built(folder, header, main, compiler=("gcc", "-std=c99")):
    """What a program that includes the header prints, in words."""
    (folder / "line.h").write_text(header)
    (folder / "main.c").write_text(main)
    strict = ("-Wall", "-Wextra", "-Werror", "-I.", "-x")
    language = "c" if compiler[0] == "gcc" else "c++"
    build = [*compiler, *strict, language, "main.c", "-o", "main"]
    subprocess.run(build, cwd=folder, check=True)
    done = subprocess.run([folder / "main"], capture_output=True, text=True, check=True)
    return done.stdout.split()


FINE = {
    joint: JointServo(center=614, counts_per_radian=2048 / np.pi, limits=(-0.9, 4))
    for joint in JOINTS
}


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler")
@pytest.mark.parametrize("walk", ["of pulses", "of a bus"])
@pytest.mark.parametrize("unit", ["counts", "microseconds"])
def test_the_header_compiles_and_says_the_same_in_c(commands, tmp_path, walk, unit):
    servos = table(given=MIRRORED)
    if walk == "of a bus":
        servos = table(kind="xl-330", given=FINE)
        commands = servos.commands(walking(), 60.0)
    servos = servos.in_microseconds() if unit == "microseconds" else servos
    header = write_header(commands, servos, **TITLE)
    *numbers, rate = built(tmp_path, header, MAIN)
    channels, counts = numbers[: len(JOINTS)], numbers[len(JOINTS) :]
    assert channels == [str(servo.channel) for servo in servos.channels]
    assert counts == [str(count) for count in servos.counts(commands).ravel()]
    assert float(rate) == 60


BOARD = """
#pragma once
#include <stdint.h>
#include <stdio.h>
static uint32_t now = 0;
static inline uint32_t micros() { return now; }
struct Adafruit_PWMServoDriver {
  void begin() {}
  void setOscillatorFrequency(double) {}
  void setPWMFreq(double) {}
  void setPWM(int channel, int on, int off) {
    printf("%u %d %d ", now, channel, on + off);
  }
};
"""
LOOP = """
int main() {
  setup();
  for (now = 0; now < 4000000; now += 500) loop();
  return 0;
}
"""


@pytest.mark.parametrize("name", ["walk", "frame", "my frame rate"])
def test_a_header_is_read_back_at_the_rate_of_its_rows_not_of_its_frames(name):
    servos = table(given=MIRRORED)
    slow = ServoCommands(JOINTS, 10.0, np.zeros((20, len(JOINTS))))
    header = write_header(slow, servos, **TITLE | {"name": name})
    assert servos.frame_rate != 10.0
    assert read_header(header, servos).rate == 10.0


@pytest.mark.skipif(shutil.which("g++") is None, reason="no C++ compiler")
def test_the_sketch_in_the_comment_gives_every_row_at_its_time(commands, tmp_path):
    servos = table(given=MIRRORED)
    angles = np.repeat(commands.angles[:100], 2, axis=0)  # rows that hold
    commands = ServoCommands(JOINTS, 60.0, angles)
    header = write_header(commands, servos, **TITLE)
    _, _, sketch = header.partition("Library:\n")
    (tmp_path / "Adafruit_PWMServoDriver.h").write_text(BOARD)
    main = sketch.partition("*/")[0] + LOOP
    found = np.array(built(tmp_path, header, main, ("g++", "-std=c++11")), dtype=int)
    times, channels, counts = found.reshape(-1, len(JOINTS), 3).T
    wanted = [servo.channel for servo in servos.channels]
    assert (np.array(wanted) == channels.T).all()
    when = np.round(times[0] / 1e6 * 60 - 0.015).astype(int)  # looked at twice a ms
    assert (when == np.arange(0, 200, 2)).all()
    rows = servos.counts(commands)[::2]
    assert (rows == counts.T).all()


@pytest.mark.physics
def test_a_minute_of_walking_fits_into_40_kb_of_text(walked):
    """In counts of 4096 a turn, 100 a second, as the finest makes take them."""
    ctrl = np.load(walked / "commands.npz")["ctrl"]
    joints = np.arange(len(JOINTS))
    commands = taken(ctrl, JOINTS, joints, rate=100.0, timestep=0.001)
    servos = table(kind="xl-330", given=FINE)
    assert (np.diff(servos.counts(commands), axis=0) != 0).any(axis=0).all()
    minute = np.tile(commands.angles, (4, 1))  # 15 s of walking, four times
    minutes = len(minute) / 6000
    text = write_header(ServoCommands(JOINTS, 100.0, minute), servos, **TITLE)
    assert len(text) < 40e3 * minutes  # 33 kB were measured


def test_rows_are_packed_by_what_changes_and_unpacked_as_they_were():
    draw = np.random.default_rng(4)
    counts = 300 + np.cumsum(draw.integers(-2, 3, (900, 18)), axis=0)
    counts[100:800] = counts[100]  # longer than a byte counts
    counts[850, 3] += 200  # farther than a byte holds
    counts[851, 3] -= 127
    counts[852, 4] -= 128
    packed = pack(counts)
    assert (unpack(packed, 18) == counts).all()
    assert len(packed) < 200 * (1 + 3 + 18) + 3 * 4
    assert (unpack(pack(np.zeros((3, 2), dtype=int)), 2) == 0).all()


def test_a_header_says_where_its_mounting_is_assumed(commands):
    angles = ServoCommands(JOINTS, 60.0, 0.1 * commands.angles)
    on_channels = {joint: JointServo(channel=n) for n, joint in enumerate(JOINTS)}
    guessed, known = (
        write_header(angles, t, **TITLE) for t in (table(), table(given=on_channels))
    )
    assert "// Mounting ASSUMED: these channels" in guessed
    assert "ASSUMED" not in known


@pytest.mark.parametrize("lost", ["static const char PROGMEM", "line_channel", "_RATE"])
def test_a_header_that_lacks_a_part_is_no_table_of_pulses(commands, lost):
    own = table()
    whole = write_header(commands, own, **TITLE)
    text = "\n".join(line for line in whole.splitlines() if lost not in line)
    assert text != whole.rstrip("\n")
    with pytest.raises(ValueError, match="no table of pulses in PROGMEM"):
        read_header(text, own)
