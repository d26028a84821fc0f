const byte begin_[] = {0, 0xAE, 0xA8, 63, 0xD3, 0, 0x40, 0x8D, 0x14, 0x20, 0, 0xA1, 0xC8, 0xDA, 0x12, 0xA6, 0xAF};
void window(byte left, byte right, byte top, byte bottom) {
  start(0x78); send(0); send(0x21); send(left); send(right); send(0x22); send(top); send(bottom); stop();
}
void fill(byte dots, int count) { start(0x78); send(0x40); while (count--) send(dots); stop(); }
void setup() {
  TWBR = 12;
  start(0x78); for (byte each : begin_) send(each); stop();
  window(0, 127, 0, 7); fill(0, 1024);
  window(8, 11, 1, 1); fill(0x81, 4);
  delay(1000);
  start(0x78); send(0x80); send(0xA7); send(0x80); send(0xE3); stop();
  delay(1000);
  start(0x78); send(0); send(0xA6); stop();
}
void loop() {}
