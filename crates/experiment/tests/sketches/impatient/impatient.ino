// Pins 20 and 21 with nothing connected. A sonar triggered by port writes around delayMicroseconds(4): 3.1 us. Nobody feeds the watchdog.

#include <avr/wdt.h>

void setup() {
  Serial.begin(9600);
  if (!digitalRead(20) || !digitalRead(21)) Serial.println("low");
  wdt_enable(WDTO_500MS);
  DDRJ |= _BV(1);  // Pin 14.
}

void loop() {
  PORTJ |= _BV(1);
  delayMicroseconds(4);
  PORTJ &= ~_BV(1);
  Serial.println(pulseIn(3, HIGH, 40000) / 58);
  delay(60);
}
