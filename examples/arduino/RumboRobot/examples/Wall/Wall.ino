// Drives to a wall and stops 30 cm before it.
//   rumbo run mode1-final --sketch Wall            the Mega of the final build
//   rumbo run mode1 --robot uno --sketch Wall      an Uno
#include <RumboRobot.h>

const float WALL_CM = 30, GAIN = 6;
const int LEAST_PWM = 65, MOST_PWM = 120;  // below LEAST_PWM the wheels do not turn

RumboRobot robot;
unsigned long plotted_ms;

void setup() {
  Serial.begin(115200);
  robot.begin();
  robot.look(90);
}

void loop() {
  robot.update();
  float cm = robot.distance(), error = cm - WALL_CM;
  int pwm = 0;
  if (cm > 0 && robot.age() < 200 && abs(error) > 1) {
    pwm = constrain(GAIN * error + (error > 0 ? LEAST_PWM : -LEAST_PWM), -MOST_PWM, MOST_PWM);
  }
  robot.drive(pwm, pwm);
  if (millis() - plotted_ms >= 100) {
    plotted_ms += 100;
    robot.plot("cm", cm);
    robot.plot("pwm", pwm);
    robot.plotEnd();
  }
}
