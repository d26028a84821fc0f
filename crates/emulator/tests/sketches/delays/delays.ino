// Pin 22 changes its level after each delay: of 1 to 16,000 us with interrupts off, then of 1 to 100 ms.

#define AFTER(us) delayMicroseconds(us); PINA = 1

void setup() {
  DDRA = 1;
  noInterrupts();
  PINA = 1;
  AFTER(3);
  AFTER(10);
  AFTER(100);
  AFTER(1000);
  AFTER(16000);
  interrupts();
  delay(3);
  PINA = 1;
  delay(1);
  PINA = 1;
  delay(20);
  PINA = 1;
  delay(100);
  PINA = 1;
}

void loop() {
}
