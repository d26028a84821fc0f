// Prints what the sonars measure, that in front ahead and to the right, and backs to 30 cm from what is behind.
#include <Servo.h>
Servo servo;
int mm(byte trigger, byte echo) {
  digitalWrite(trigger, HIGH); delayMicroseconds(12); digitalWrite(trigger, LOW);
  int mm = pulseIn(echo, HIGH, 30000) / 5.82;
  delay(60);
  return mm;
}
const byte pins[] = {2, 4, 5, 6, 7, 8, 10, A0, A2, A4};
void setup() {
  Serial.begin(115200);
  for (byte pin : pins) pinMode(pin, OUTPUT);
  servo.attach(3);
  for (byte angle = 35; angle < 130; angle += 90) {
    servo.write(angle);
    delay(600);
    Serial.println(mm(A0, A1));
  }
  Serial.println(mm(10, 11));
  Serial.println(mm(A2, A3));
  Serial.println(mm(A4, A5));
  digitalWrite(4, HIGH); digitalWrite(8, HIGH);
  bool fine = digitalRead(12) && digitalRead(13);
  while (fine && mm(A2, A3) > 300) { analogWrite(5, 150); analogWrite(6, 150); }
  analogWrite(5, 0); analogWrite(6, 0);
}
void loop() {}
