void setup() {
  pinMode(5, OUTPUT); digitalWrite(5, HIGH); analogWrite(6, 200);
  pinMode(9, OUTPUT); digitalWrite(9, HIGH); analogWrite(10, 200);
}
void loop() {}
