// All sixteen analog inputs.

volatile int readings[16];
volatile unsigned long conversions_us;
volatile bool done = false;

void setup() {
  // The first conversion after start takes longer.
  analogRead(A0);
  unsigned long before = micros();
  for (int channel = 0; channel < 16; channel++) {
    readings[channel] = analogRead(channel);
  }
  conversions_us = micros() - before;
  done = true;
}

void loop() {
}
