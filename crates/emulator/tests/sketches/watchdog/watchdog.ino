// The watchdog is fed three times, then forgotten: a reset after its 250 ms. The cause of the last reset is kept.

#include <avr/wdt.h>

volatile byte cause;

void setup() {
  cause = MCUSR;
  MCUSR = 0;
  wdt_disable();
  DDRA = 1;
  PORTA = 1;
  wdt_enable(WDTO_250MS);
  for (byte i = 0; i < 3; i++) {
    delay(100);
    wdt_reset();
    PINA = 1;
  }
}

void loop() {
}
