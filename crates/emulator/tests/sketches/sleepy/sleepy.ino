// Sleep in every depth, woken by watchdog, pin change, external interrupt and timer.

#include <avr/sleep.h>
#include <avr/wdt.h>

volatile byte watchdogs = 0, pins = 0, externals = 0, compares = 0;
volatile byte stage = 0;
volatile unsigned long awake_ms = 0;

ISR(WDT_vect) { watchdogs++; }
ISR(PCINT2_vect) { pins++; }
ISR(TIMER1_COMPA_vect) { compares++; }

void wake() {
  externals++;
  detachInterrupt(digitalPinToInterrupt(2));
}

void sleep_in(byte mode) {
  set_sleep_mode(mode);
  noInterrupts();
  sleep_enable();
  interrupts();
  sleep_cpu();
  sleep_disable();
}

void setup() {
  DDRA = 1;
  // Half a second of the watchdog, three times.
  MCUSR = 0;
  WDTCSR = _BV(WDCE) | _BV(WDE);
  WDTCSR = _BV(WDIE) | _BV(WDP2) | _BV(WDP0);
  unsigned long before = millis();
  for (byte round = 0; round < 3; round++) {
    sleep_in(SLEEP_MODE_PWR_DOWN);
    PINA = 1;
  }
  awake_ms = millis() - before;
  wdt_disable();
  stage = 1;
  // A pin change on A8.
  pinMode(A8, INPUT_PULLUP);
  PCMSK2 = 1;
  PCICR = _BV(PCIE2);
  sleep_in(SLEEP_MODE_PWR_SAVE);
  PCICR = 0;
  stage = 2;
  // A low level on pin 2.
  pinMode(2, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(2), wake, LOW);
  sleep_in(SLEEP_MODE_STANDBY);
  stage = 3;
  // Timer 1, 10 ms, in idle; timer 0 would wake it first.
  TIMSK0 = 0;
  TCCR1A = 0;
  TCCR1B = _BV(WGM12) | _BV(CS11);
  OCR1A = 19999;
  TCNT1 = 0;
  TIFR1 = _BV(OCF1A);
  TIMSK1 = _BV(OCIE1A);
  PINA = 1;
  for (byte round = 0; round < 5; round++) {
    sleep_in(SLEEP_MODE_IDLE);
  }
  PINA = 1;
  TIMSK1 = 0;
  stage = 4;
  // The end of all: nothing is enabled that could wake it.
  noInterrupts();
  sleep_in(SLEEP_MODE_PWR_DOWN);
  stage = 5;
}

void loop() {
}
