"""Commands as a C header: pulses of PCA9685 servos in PROGMEM, with a player sketch."""

from __future__ import annotations

import re

import numpy as np

from planner import Array
from sim.export.servo_commands import ServoCommands
from sim.export.servo_table import ServoTable

PLAYER = """\
/* A player for Arduino, with the Adafruit PWM Servo Driver Library:

#include <Adafruit_PWMServoDriver.h>
#include "{file}"

Adafruit_PWMServoDriver board;
uint32_t row = 0, begun;

void setup() {{
  board.begin();
  board.setPWMFreq({NAME}_FRAME_RATE);
  begun = micros();
}}

void loop() {{
  if (row == {NAME}_COMMANDS || micros() - begun < row * (1e6 / {NAME}_RATE)) return;
  for (uint8_t i = 0; i < {NAME}_JOINTS; i++)
    board.{call};
  row++;
}}
*/
"""
COUNTS = "setPWM({name}_channel[i], 0, pgm_read_word(&{name}[row][i]))"
MICROSECONDS = "writeMicroseconds({name}_channel[i], pgm_read_word(&{name}[row][i]))"
HEADER = """\
// {title}
// {commands} commands of {joints} servos, {rate!r} a second; {size} bytes.
// Pulses {unit} at {frame_rate!r} frames a second, in the order of the channels:
{listed}
{player}
#ifndef {NAME}_H
#define {NAME}_H

#include <stdint.h>
#ifdef ARDUINO
#include <Arduino.h>
#endif
#ifndef PROGMEM
#define PROGMEM
#endif

#define {NAME}_RATE {rate!r}
#define {NAME}_FRAME_RATE {frame_rate!r}
#define {NAME}_COMMANDS {commands}
#define {NAME}_JOINTS {joints}

static const uint8_t {name}_channel[{joints}] = {{{channels}}};

static const uint16_t PROGMEM {name}[{commands}][{joints}] = {{
{rows}
}};

#endif
"""
SIZES = re.compile(r"#define \w+_(RATE|FRAME_RATE|COMMANDS|JOINTS) (\S+)")
ROWS = re.compile(r"uint16_t PROGMEM \w+\[\d+\]\[\d+\] = \{\n(.*?)\n\};", re.DOTALL)
CHANNELS = re.compile(r"uint8_t \w+_channel\[\d+\] = \{(.*?)\};")


def write_header(
    commands: ServoCommands,
    table: ServoTable,
    *,
    title: str,
    name: str,
    file: str,
) -> str:
    """The header, a row a command and a column a channel, its table named after `name`.

    A joint that leaves its servo's range is a UsageError.
    """
    counts, name = table.counts(commands), identifier(name)
    names = {"name": name, "NAME": name.upper()}
    call = (MICROSECONDS if table.microseconds else COUNTS).format(**names)
    numbers = [str(servo.channel) for servo in table.channels]
    return HEADER.format(
        **names,
        title=" ".join(title.replace("\\", "/").split()),
        commands=len(counts),
        joints=len(numbers),
        rate=float(commands.rate),
        frame_rate=float(table.frame_rate),
        size=2 * counts.size,
        unit="in microseconds" if table.microseconds else "in counts of 4096 a frame",
        listed="\n".join(f"//   {s.channel:2}  {s.joint}" for s in table.channels),
        player=PLAYER.format(**names, file=file, call=call),
        channels=", ".join(numbers),
        rows=",\n".join(f"  {{{', '.join(map(str, r))}}}" for r in counts.tolist()),
    )


def read_header(text: str, table: ServoTable) -> ServoCommands:
    """Read what `write_header` wrote; any other text is a ValueError."""
    rows, channels = ROWS.search(text), CHANNELS.search(text)
    sizes = dict(SIZES.findall(text))
    if rows is None or channels is None or "RATE" not in sizes:
        raise ValueError("no table of pulses in PROGMEM")
    found = [int(number) for number in channels[1].split(",")]
    if found != [servo.channel for servo in table.channels]:
        raise ValueError(f"channels {found} are not those of the servo table")
    shape = int(sizes["COMMANDS"]), int(sizes["JOINTS"])
    counts: Array = np.array(re.findall(r"\d+", rows[1]), dtype=int).reshape(shape)
    return table.commands(counts, float(sizes["RATE"]))


def identifier(name: str) -> str:
    """A name in C, of the letters and digits of a name."""
    return "walk_" + re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_").lower()
