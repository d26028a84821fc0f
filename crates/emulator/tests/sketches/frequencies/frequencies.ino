// analogWrite at other frequencies: the prescaler changed, 20 kHz with ICR as the top, and timers of the core's own.

volatile bool done = false;

void setup() {
  pinMode(10, OUTPUT);
  analogWrite(5, 100);
  TCCR3B = (TCCR3B & 0b11111000) | 1;  // 31.4 kHz
  analogWrite(6, 200);
  TCCR4B = (TCCR4B & 0xF8) | 2;        // 3.9 kHz
  // Timer 1 at 20 kHz, phase correct: pins 11 and 12.
  pinMode(11, OUTPUT);
  pinMode(12, OUTPUT);
  TCCR1A = _BV(COM1A1) | _BV(COM1B1) | _BV(COM1B0) | _BV(WGM11);
  TCCR1B = _BV(WGM13) | _BV(CS10);
  ICR1 = 400;
  OCR1A = 100;
  OCR1B = 100;
  // Fast PWM of timer 2 on pin 9, 62.5 kHz.
  TCCR2A = _BV(COM2B1) | _BV(WGM21) | _BV(WGM20);
  TCCR2B = _BV(CS20);
  OCR2B = 63;
  pinMode(9, OUTPUT);
  delay(20);
  analogWrite(5, 0);
  analogWrite(6, 255);
  delay(5);
  analogWrite(5, 1);
  analogWrite(6, 254);
  done = true;
}

void loop() {
}
