volatile long count;
void edge() { count += digitalRead(4) ? 1 : -1; }
void setup() {
  Serial.begin(115200);
  pinMode(5, OUTPUT); pinMode(7, OUTPUT); pinMode(8, OUTPUT);
  attachInterrupt(digitalPinToInterrupt(2), edge, RISING);
  digitalWrite(7, HIGH); analogWrite(5, 200);
  delay(1000); Serial.println(count);
  digitalWrite(7, LOW); digitalWrite(8, HIGH);
  delay(1900); Serial.println(count);
}
void loop() {}
