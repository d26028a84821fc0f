// A master of the two-wire bus at 400 kHz: `send` tells whether it was acknowledged.
void wait() { while (!(TWCR & _BV(TWINT))) {} }
bool send(byte value) {
  TWDR = value; TWCR = _BV(TWINT) | _BV(TWEN); wait();
  byte status = TWSR & 0xF8;
  return status == 0x18 || status == 0x28 || status == 0x40;
}
bool start(byte address) { TWCR = _BV(TWINT) | _BV(TWSTA) | _BV(TWEN); wait(); return send(address); }
void stop() { TWCR = _BV(TWINT) | _BV(TWSTO) | _BV(TWEN); while (TWCR & _BV(TWSTO)) {} }
byte receive(bool more) { TWCR = _BV(TWINT) | _BV(TWEN) | (more ? _BV(TWEA) : 0); wait(); return TWDR; }
