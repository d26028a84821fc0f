const byte pins[] = {2, 5, 6, 9, 10};
void setup() { for (byte pin : pins) pinMode(pin, OUTPUT); pinMode(3, MODE); }
void loop() {
  digitalWrite(2, HIGH); delayMicroseconds(10); digitalWrite(2, LOW);
  bool far = pulseIn(3, HIGH, 30000) > 3000;
  digitalWrite(5, far); digitalWrite(9, far); delay(50);
}
