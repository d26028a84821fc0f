// The analog inputs, and the two buses with nothing connected.

#include <SPI.h>
#include <Wire.h>

volatile int volts[16];
volatile byte wire_result, spi_result;
volatile unsigned long conversion_us;
volatile bool done = false;

void setup() {
  // The first conversion after start takes longer.
  analogRead(A0);
  unsigned long before = micros();
  for (int channel = 0; channel < 16; channel++) {
    volts[channel] = analogRead(channel);
  }
  conversion_us = micros() - before;
  Wire.begin();
  Wire.beginTransmission(0x68);
  Wire.write(0);
  wire_result = Wire.endTransmission();
  SPI.begin();
  spi_result = SPI.transfer(0x55);
  done = true;
}

void loop() {
}
