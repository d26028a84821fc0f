// Two servos sweep against each other in steps of 45 degrees, half a second each.

#include <Servo.h>

Servo one, other;

void setup() {
  one.attach(9);
  other.attach(10);
}

void loop() {
  for (int angle = 0; angle <= 180; angle += 45) {
    one.write(angle);
    other.write(180 - angle);
    delay(500);
  }
}
