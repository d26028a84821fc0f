void setup() { Serial.begin(115200); Serial1.begin(9600); pinMode(7, OUTPUT); delay(100); Serial.println("ready"); }
void loop() {
  if (Serial.read() == 'P') {
    digitalWrite(7, HIGH); delayMicroseconds(500); digitalWrite(7, LOW);
    Serial.println(analogRead(A0));
  }
  int got = Serial1.read();
  if (got >= 0) { Serial1.print("got "); Serial1.println(char(got)); analogWrite(9, 128); }
}
