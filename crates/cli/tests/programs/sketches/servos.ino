#include <Servo.h>
Servo left, right;
void setup() {
  left.attach(13); right.attach(12);
  left.writeMicroseconds(1700); right.writeMicroseconds(1300); delay(2000);
  left.write(90); right.write(90);
}
void loop() {}
