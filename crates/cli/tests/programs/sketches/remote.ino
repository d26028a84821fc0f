// Drives by the keys of a remote, told by the time from one falling edge to the next.
volatile unsigned long last, bits;
volatile byte count = 99;
volatile int got = -1, repeats = 0;
void fall() {
  unsigned long now = micros(), gap = now - last;
  last = now;
  if (gap > 13000 && gap < 14000) { count = 0; return; }
  if (gap > 11000 && gap < 11500) { repeats++; return; }
  if (count > 31 || gap < 1000 || gap > 2400) { count = 99; return; }
  bits = bits >> 1 | (gap > 1700 ? 0x80000000 : 0);
  if (++count == 32 && (bits & 0xFFFF) == 0xFF00 && (byte)(bits >> 16) == (byte)~(bits >> 24)) got = bits >> 16 & 0xFF;
}
void setup() {
  Serial.begin(115200);
  for (byte pin = 5; pin <= 12; pin++) pinMode(pin, OUTPUT);
  attachInterrupt(digitalPinToInterrupt(2), fall, FALLING);
}
void loop() {
  if (repeats) { repeats--; Serial.println("again"); }
  if (got < 0) return;
  Serial.println(got, HEX);
  digitalWrite(7, got == 0x18); digitalWrite(12, got == 0x18);
  analogWrite(5, 150); analogWrite(6, 150);
  got = -1;
}
