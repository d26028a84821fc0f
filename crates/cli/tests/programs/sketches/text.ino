const byte arrow[] = {4, 14, 31, 4, 4, 4, 0, 0};
void lines(byte value) { start(0x4E); send(value); stop(); }
void half(byte value) { lines(value | 0x0C); lines(value | 0x08); delayMicroseconds(50); }
void put(byte value, byte rs) { half(value & 0xF0 | rs); half(value << 4 | rs); }
void print(byte at, const char *text) { put(0x80 | at, 0); while (*text) put(*text++, 1); }
void setup() {
  TWBR = 72;
  delay(50);
  half(0x30); delay(5); half(0x30); delay(1); half(0x30); half(0x20);
  put(0x28, 0); put(0x0C, 0); put(0x06, 0); put(0x01, 0); delay(2);
  put(0x40, 0);
  for (byte row : arrow) put(row, 1);
  print(0x00, "Rumbo");
  print(0x14, "third row");
  print(0x40, ""); put(0, 1); put(0xDF, 1);
}
void loop() {}
