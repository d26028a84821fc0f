// micros() and millis() when pin 22 changes its level.

volatile unsigned long micros_at[200];
volatile unsigned long millis_at[200];
volatile byte count = 0;

void setup() {
  DDRA = 1;
}

void loop() {
  if (count < 200) {
    noInterrupts();
    unsigned long now = micros();
    PINA = 1;
    interrupts();
    micros_at[count] = now;
    millis_at[count] = millis();
    count++;
    delayMicroseconds(977 * (count & 15) + 3);
  }
}
