// Three ways to time an echo: a timer that polls the pin every 24 us, input capture, and pulseIn with a time-out.

volatile unsigned int ticks = 0, ping_us = 0;
volatile bool waiting = false;
volatile unsigned int captured_ticks = 0, captures = 0, began = 0;
volatile unsigned long given_up_us, gave, seen_us;
volatile bool done = false;

ISR(TIMER2_COMPA_vect) {
  if (!waiting) return;
  ticks++;
  if (!(PINE & _BV(PE4))) {  // pin 2
    waiting = false;
    ping_us = ticks * 24;
  }
}

ISR(TIMER5_CAPT_vect) {
  if (TCCR5B & _BV(ICES5)) {
    began = ICR5;
  } else {
    captured_ticks = ICR5 - began;
    captures++;
  }
  TCCR5B ^= _BV(ICES5);
  TIFR5 = _BV(ICF5);
}

void setup() {
  pinMode(3, OUTPUT);
  pinMode(2, INPUT);
  pinMode(48, INPUT);
  TCCR2A = _BV(WGM21);
  TCCR2B = _BV(CS22);  // over 64: 4 us
  OCR2A = 5;
  TIMSK2 = _BV(OCIE2A);
  TCCR5A = 0;
  TCCR5B = _BV(ICNC5) | _BV(ICES5) | _BV(CS51);  // half microseconds
  TIFR5 = _BV(ICF5);
  TIMSK5 = _BV(ICIE5);

  digitalWrite(3, HIGH);
  delayMicroseconds(10);
  digitalWrite(3, LOW);
  while (!(PINE & _BV(PE4))) {
  }
  ticks = 0;
  waiting = true;
  while (waiting) {
  }
  TIMSK2 = 0;

  unsigned long start = micros();
  gave = pulseIn(2, HIGH, 25000);
  given_up_us = micros() - start;
  digitalWrite(3, HIGH);
  delayMicroseconds(10);
  digitalWrite(3, LOW);
  seen_us = pulseIn(2, HIGH, 25000);
  done = true;
}

void loop() {
}
