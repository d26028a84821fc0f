// Stands in for the Arduino IDE's Servo library, which Debian does not package: the same interface for the Mega, and the
// same way of making pulses. Timer 5 counts half microseconds; its compare interrupt raises one servo's pin after the
// other and lowers it when that servo's pulse is over, 20 ms from round to round. Pins 44 to 46 lose their PWM.

#pragma once

#include <Arduino.h>

class Servo {
public:
  Servo();
  // Pulses start at once, 1.5 ms unless something was written before. 0 degrees is `least` microseconds, 180 is `most`.
  uint8_t attach(int pin, int least = 544, int most = 2400);
  void detach();
  bool attached() const;
  // Degrees below 544, microseconds from there on.
  void write(int value);
  void writeMicroseconds(int microseconds);
  int read() const;
  int readMicroseconds() const;

private:
  uint8_t index;
  int least, most;
};
