bool dark(byte pin) { return digitalRead(pin) == LOW; }
void setup() { for (byte pin = 5; pin <= 11; pin++) if (pin != 10) pinMode(pin, OUTPUT); }
void drive(int left, int right) {
  digitalWrite(7, left > 0); digitalWrite(8, left < 0); digitalWrite(11, right > 0); digitalWrite(9, right < 0);
  analogWrite(5, abs(left)); analogWrite(6, abs(right));
}
int side = 0;
void loop() {
  if (dark(2)) side = -1; else if (dark(10)) side = 1; else if (dark(4)) side = 0;
  drive(side < 0 ? -80 : 80, side > 0 ? -80 : 80);
}
