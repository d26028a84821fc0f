int lasts_us(byte pin) {
  pinMode(pin, OUTPUT); digitalWrite(pin, HIGH); delayMicroseconds(10); pinMode(pin, INPUT);
  unsigned long begin = micros();
  while (digitalRead(pin) && micros() - begin < 2500) ;
  return micros() - begin;
}
bool dark(byte pin) { return IS_DARK; }
void setup() { DDRD |= 0xE0; DDRB |= 0x28; pinMode(12, INPUT_PULLUP); while (digitalRead(12)) ; }
void loop() {
  bool left = dark(2), right = dark(A0);
  digitalWrite(13, dark(4)); digitalWrite(7, HIGH); digitalWrite(11, HIGH);
  analogWrite(5, left ? 0 : 90); analogWrite(6, right ? 0 : 90);
}
