/* Moves one servo at a time, and measures the clock of a PCA9685.

For an Arduino with the Adafruit PWM Servo Driver Library; Serial Monitor at 115200:
  3 371   channel 3 goes to count 371, one count after another
  j 3     channel 3 goes up by {{ JOG }} counts and back, three times
  k       the clock: connect the signal of channel 15 to pin 2, without a servo
*/

#include <Adafruit_PWMServoDriver.h>

const uint8_t FREE_CHANNEL = 15, PIN = 2;
const float NOMINAL = {{ CLOCK }};  // [Hz]; counts below are for this clock
const float RATE = {{ RATE }};      // frames a second, if the clock is the nominal one
const uint16_t MIDDLE = {{ MIDDLE }}, JOG = {{ JOG }};

Adafruit_PWMServoDriver board;
uint16_t at[16];

void go(uint8_t channel, uint16_t count) {
  if (!at[channel]) at[channel] = count;  // nobody knows where it is
  while (at[channel] != count) {
    at[channel] += at[channel] < count ? 1 : -1;
    board.setPWM(channel, 0, at[channel]);
    delay(10);
  }
  board.setPWM(channel, 0, count);
}

void jog(uint8_t channel) {
  uint16_t here = at[channel] ? at[channel] : MIDDLE;
  go(channel, here);
  for (uint8_t i = 0; i < 3; i++) {
    go(channel, here + JOG);
    delay(500);
    go(channel, here);
    delay(500);
  }
}

void measure() {
  double sum = 0;
  board.setPWM(FREE_CHANNEL, 0, 2048);  // half of every frame
  delay(100);
  for (uint8_t i = 0; i < 100; i++) sum += pulseIn(PIN, HIGH, 100000);
  board.setPWM(FREE_CHANNEL, 0, 0);
  Serial.print("clock [MHz]: ");
  Serial.println({{ DIVIDER }} * 2048.0 / (sum / 100), 3);
}

void setup() {
  Serial.begin(115200);
  board.begin();
  board.setOscillatorFrequency(NOMINAL);
  board.setPWMFreq(RATE);
  pinMode(PIN, INPUT);
}

void loop() {
  if (!Serial.available()) return;
  String line = Serial.readStringUntil('\n');
  line.trim();
  if (line == "k") return measure();
  bool jogs = line.startsWith("j ");
  String rest = jogs ? line.substring(2) : line;
  int space = rest.indexOf(' ');
  long channel = rest.toInt(), count = rest.substring(space + 1).toInt();
  if (channel < 0 || channel > 15) return;
  if (jogs) return jog(channel);
  if (space > 0 && count > 0 && count < 4096) go(channel, count);
  Serial.println(at[channel]);
}
