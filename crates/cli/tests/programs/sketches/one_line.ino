void setup() { Serial.begin(115200); }
void loop() {
  pinMode(10, OUTPUT); digitalWrite(10, LOW); delayMicroseconds(2);
  digitalWrite(10, HIGH); delayMicroseconds(10); digitalWrite(10, LOW);
  pinMode(10, INPUT);
  Serial.println(pulseIn(10, HIGH, 30000) / 58);
  delay(100);
}
