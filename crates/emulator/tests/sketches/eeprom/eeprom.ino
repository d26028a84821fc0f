// Counts its starts in the EEPROM, and keeps a structure there.

#include <EEPROM.h>

struct Settings {
  float gain;
  int offset;
};

volatile byte starts;
volatile unsigned long write_us, update_us;
Settings settings;

void setup() {
  starts = EEPROM.read(0) + 1;
  unsigned long before = micros();
  EEPROM.write(0, starts);
  EEPROM.write(4095, 0x5A);
  eeprom_busy_wait();
  write_us = micros() - before;
  // Nothing changes: update() must not write.
  before = micros();
  EEPROM.update(4095, 0x5A);
  update_us = micros() - before;
  EEPROM.put(100, Settings{1.5f, -7});
  EEPROM.get(100, settings);
}

void loop() {
}
