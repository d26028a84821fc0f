volatile byte state, bits;
volatile unsigned int ticks;
volatile unsigned long value;
volatile bool done;
ISR(TIMER2_COMPA_vect) {
  bool mark = !(PINB & _BV(3));
  ticks++;
  if (done) return;
  if (state == 0 && mark) { state = 1; ticks = 0; }
  else if (state == 1 && !mark) { state = ticks > 160 ? 2 : 0; ticks = 0; }
  else if (state == 2 && mark) { state = ticks > 70 ? 3 : 0; bits = 0; ticks = 0; }
  else if (state == 3 && !mark) { state = 4; ticks = 0; }
  else if (state == 4 && mark) {
    value = value << 1 | (ticks > 22);
    state = 3; ticks = 0;
    if (++bits == 32) { done = true; state = 0; }
  }
}
void setup() {
  Serial.begin(115200);
  pinMode(11, INPUT);
  TCCR2A = _BV(WGM21); TCCR2B = _BV(CS21); OCR2A = 99; TIMSK2 = _BV(OCIE2A);
}
void loop() { if (done) { Serial.println(value, HEX); delay(150); done = false; } }
