// The two buses with nothing connected.

#include <SPI.h>
#include <Wire.h>

volatile byte wire_result, spi_result;
volatile bool done = false;

void setup() {
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
