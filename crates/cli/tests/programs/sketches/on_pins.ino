// A display of letters on six pins.
const byte data[] = {4, 9, 10, 13};
void half(byte value) {
  for (byte bit = 0; bit < 4; bit++) digitalWrite(data[bit], value >> bit & 1);
  digitalWrite(3, HIGH); delayMicroseconds(1); digitalWrite(3, LOW); delayMicroseconds(100);
}
void put(byte value, bool letter) { digitalWrite(2, letter); half(value >> 4); half(value); }
void setup() {
  pinMode(2, OUTPUT); pinMode(3, OUTPUT);
  for (byte pin : data) pinMode(pin, OUTPUT);
  delay(50);
  half(3); delay(5); half(3); delay(1); half(3); half(2);
  put(0x28, 0); put(0x0C, 0); put(0x06, 0); put(0x01, 0); delay(2);
  for (const char *text = "on pins"; *text; text++) put(*text, 1);
  put(0xC3, 0); put('!', 1);
}
void loop() {}
