// {{ title }}
// {{ commands }} commands of {{ joints }} servos, {{ rate }} a second; {{ size }} bytes.
// Pulses {{ unit }} at {{ frame_rate }} frames a second, in the order of the channels:
{% if assumed %}
// Mounting ASSUMED: these channels, all senses +, centres alike; stratawalk calibrate ROBOT measures it.
{% endif %}
{{ listed }}
/* A player for Arduino, with the Adafruit PWM Servo Driver Library:

#include <Adafruit_PWMServoDriver.h>
#include "{{ file }}"

Adafruit_PWMServoDriver board;
uint16_t row[{{ NAME }}_JOINTS];
uint32_t command = 0, begun;

void setup() {
  board.begin();
  board.setOscillatorFrequency({{ NAME }}_CLOCK);
  board.setPWMFreq({{ NAME }}_FRAME_RATE);
  begun = micros();
}

void loop() {
  if (micros() - begun < command * (1e6 / {{ NAME }}_RATE)) return;
  uint8_t held = {{ name }}_next(row);
  if (!held) return;
  for (uint8_t i = 0; i < {{ NAME }}_JOINTS; i++)
    board.{{ call }};
  command += held;
}
*/

#ifndef {{ NAME }}_H
#define {{ NAME }}_H

#include <stdint.h>
#ifdef ARDUINO
#include <Arduino.h>
#endif
#ifndef PROGMEM
#define PROGMEM
#define pgm_read_byte(place) (*(place))
#endif

#define {{ NAME }}_RATE {{ rate }}
#define {{ NAME }}_FRAME_RATE {{ frame_rate }}
#define {{ NAME }}_CLOCK {{ clock }}
#define {{ NAME }}_COMMANDS {{ commands }}
#define {{ NAME }}_JOINTS {{ joints }}
#define {{ NAME }}_BYTES {{ size }}

static const uint8_t {{ name }}_channel[{{ joints }}] = { {{- channels -}} };

/* Digits in base 64; '#' is the digit 0. */
static const char PROGMEM {{ name }}[] =
{{ digits }}
;

static uint32_t {{ name }}_place = 0;

static inline uint8_t {{ name }}_digit(void) {
  return (uint8_t)(pgm_read_byte(&{{ name }}[{{ name }}_place++]) - '#');
}

/* Brings a row of pulses up to date; returns for how many commands it holds, or 0 at the end. */
static inline uint8_t {{ name }}_next(uint16_t *row) {
  uint8_t changed[({{ joints }} + 5) / 6], held, step, i;
  if ({{ name }}_place >= {{ NAME }}_BYTES) return 0;
  held = {{ name }}_digit();
  for (i = 0; i < sizeof changed; i++) changed[i] = {{ name }}_digit();
  for (i = 0; i < {{ joints }}; i++) {
    if (!(changed[i / 6] >> (i % 6) & 1)) continue;
    step = {{ name }}_digit();
    if (step < 63) {
      row[i] = (uint16_t)(row[i] + step - 31);
      continue;
    }
    row[i] = {{ name }}_digit();
    row[i] |= (uint16_t){{ name }}_digit() << 6;
    row[i] |= (uint16_t){{ name }}_digit() << 12;
  }
  return held;
}

#endif
