void set(byte reg, byte value) { start(0xD0); send(reg); send(value); stop(); }
int words[7];
void measure() {
  start(0xD0); send(0x3B); start(0xD1);
  for (byte at = 0; at < 7; at++) { words[at] = receive(true) << 8; words[at] |= receive(at < 6); }
  stop();
}
void setup() {
  Serial.begin(115200);
  TWBR = 12;
  start(0xD0); send(0x75); start(0xD1); Serial.println(receive(false), HEX); stop();
  Serial.println(start(0xD2) ? "there" : "nobody"); stop();
  for (byte pin = 5; pin <= 12; pin++) pinMode(pin, OUTPUT);
  set(0x6B, 1); set(0x1B, 0x08); set(0x1C, 0x08); set(0x1A, 3); set(0x19, 4);
  delay(100);
  long rest = 0, up = 0;
  for (int n = 0; n < 200; n++) { measure(); rest += words[6]; up += words[2]; delay(2); }
  rest /= 200;
  digitalWrite(8, HIGH); digitalWrite(12, HIGH); analogWrite(5, 110); analogWrite(6, 110);
  float degrees = 0;
  unsigned long before = micros(), end = millis() + 1200;
  while (millis() < end) {
    measure();
    unsigned long now = micros();
    degrees += (words[6] - rest) / 65.5 * (now - before) * 1e-6;
    before = now;
    if (millis() + 400 > end) { digitalWrite(8, LOW); digitalWrite(12, LOW); }
  }
  Serial.println(degrees);
  Serial.println(up / 200 / 8192.0);
}
void loop() {}
