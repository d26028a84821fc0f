void setup() { DDRD |= 0xE8; DDRB |= 1; }
void loop() {
  int error = analogRead(A2) - analogRead(A0);
  int turn = error / 12;
  digitalWrite(3, HIGH); digitalWrite(7, HIGH); digitalWrite(8, HIGH);
  analogWrite(6, constrain(85 - turn, 0, 160)); analogWrite(5, constrain(85 + turn, 0, 160));
}
