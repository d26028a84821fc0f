const byte pins[] = {5, 6, 9, 10};
void setup() { for (byte pin : pins) pinMode(pin, OUTPUT); }
void loop() {
  int volts = analogRead(A0);
  int pwm = volts < 530 || volts > 690 ? 0 : millis() < 300 ? 120 : 20;
  analogWrite(5, pwm); analogWrite(9, pwm);
}
