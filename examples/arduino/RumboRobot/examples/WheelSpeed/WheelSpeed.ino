// Holds both wheels at a speed with a PI controller each, 20 times a second.
//   rumbo lab --scenario mode5 --sketch WheelSpeed
#include <RumboRobot.h>

const unsigned long PERIOD_MS = 50;
const float SETPOINT = 600;             // edges per second
const float KP = 0.1, KI = 0.6;         // PWM per edge/s, and per edge/s in each second

struct Pi {
  float integral;
  int step(float error) {
    float pwm = KP * error + integral;
    // The integral stands still at the limits: no wind-up.
    if (pwm > 0 && pwm < 255) integral += KI * error * PERIOD_MS / 1000;
    return constrain(pwm, 0, 255);
  }
} left = {80}, right = {80};

RumboRobot robot;
unsigned long last_ms;

void setup() {
  Serial.begin(115200);
  robot.begin();
}

void loop() {
  if (millis() - last_ms < PERIOD_MS) return;
  last_ms += PERIOD_MS;
  float l = robot.leftSpeed(), r = robot.rightSpeed();
  robot.drive(left.step(SETPOINT - l), right.step(SETPOINT - r));
  robot.plot("setpoint", SETPOINT);
  robot.plot("left", l);
  robot.plot("right", r);
  robot.plotEnd();
}
