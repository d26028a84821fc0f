// Registers of devices on the two-wire bus.
void put(byte at, byte reg, byte value) { start(at << 1); send(reg); send(value); stop(); }
byte get(byte at, byte reg) {
  start(at << 1); send(reg); start(at << 1 | 1);
  byte value = receive(false);
  stop();
  return value;
}
bool there(byte at) { bool answered = start(at << 1); stop(); return answered; }
