// A serial line by software: what comes in on pin 10 goes out on pin 11 as a capital letter.

#include <SoftwareSerial.h>

SoftwareSerial line(10, 11);

void setup() {
  line.begin(9600);
}

void loop() {
  if (line.available()) {
    line.write(toupper(line.read()));
  }
}
