// millis and micros past their ends, and steps by micros.

extern volatile unsigned long timer0_millis;
extern volatile unsigned long timer0_overflow_count;

volatile unsigned long slept_ms, late_ms, micros_apart;
volatile bool done = false;
volatile unsigned int steps = 0;

void setup() {
  DDRA = 1;
  noInterrupts();
  timer0_millis = 0xFFFFFF80;
  interrupts();
  unsigned long before = millis();
  delay(300);
  slept_ms = millis() - before;
  late_ms = millis();
  noInterrupts();
  timer0_overflow_count = 0x003FFFF0;
  interrupts();
  before = micros();
  while (micros() > before) {
  }
  unsigned long start = micros();
  delayMicroseconds(5000);
  micros_apart = micros() - start;
  // A stepper at 1,250 us a step, its time added to and never set.
  unsigned long next = micros();
  for (byte step = 0; step < 200; step++) {
    while ((long)(micros() - next) < 0) {
    }
    PINA = 1;
    next += 1250;
    steps++;
  }
  done = true;
}

void loop() {
}
