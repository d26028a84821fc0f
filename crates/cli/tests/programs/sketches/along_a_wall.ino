volatile int edges;
void count() { edges++; }
bool near(int trigger, int echo) {
  digitalWrite(trigger, HIGH); delayMicroseconds(10);
  digitalWrite(trigger, LOW);
  long us = pulseIn(echo, HIGH, 30000); delay(20);
  return us > 2000 && us < 4500;
}
const byte pins[] = {4, 5, 6, 7, 9, 10};
void setup() {
  for (byte pin : pins) pinMode(pin, OUTPUT);
  attachInterrupt(digitalPinToInterrupt(2), count, CHANGE);
}
void loop() {
  bool drives = near(4, A0) && near(7, A1) && edges < 748;
  analogWrite(5, drives ? 100 : 0); analogWrite(9, drives ? 100 : 0);
}
