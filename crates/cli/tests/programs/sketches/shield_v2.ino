void set(byte output, unsigned int on, unsigned int off) {
  start(0xC0); send(6 + 4 * output); send(on); send(on >> 8); send(off); send(off >> 8); stop();
}
void run(bool forward) {
  set(2, 0, 2400); set(7, 0, 2400);
  set(4, forward ? 4096 : 0, 0); set(3, forward ? 0 : 4096, 0);
  set(5, forward ? 4096 : 0, 0); set(6, forward ? 0 : 4096, 0);
}
void setup() {
  TWBR = 72;
  start(0xC0); send(0xFE); send(3); stop();
  start(0xC0); send(0); send(0x20); stop();
  delay(1);
}
void loop() { run(true); delay(1500); run(false); delay(100000); }
