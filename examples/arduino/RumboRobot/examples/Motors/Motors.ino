// Drives a square's corner again and again: ahead, a turn to the left, a rest; the LED is on while the wheels are driven.
//   rumbo lab --scenario free --sketch Motors
#include <RumboRobot.h>

RumboRobot robot;

struct Step { int left, right, ms; };
const Step STEPS[] = {{120, 120, 1500}, {-100, 100, 500}, {0, 0, 1000}};

void setup() {
  robot.begin();
  pinMode(LED_BUILTIN, OUTPUT);
}

void loop() {
  for (const Step &step : STEPS) {
    digitalWrite(LED_BUILTIN, step.left != 0);
    robot.drive(step.left, step.right);
    delay(step.ms);
  }
}
