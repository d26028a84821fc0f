// Turns the servo from side to side, and plots what the sonar on it sees at each angle.
//   rumbo lab --scenario mode8-obstacles --sketch Sweep
#include <RumboRobot.h>

RumboRobot robot;
int angle = 30, step = 15;
unsigned long moved_ms;

void setup() {
  Serial.begin(115200);
  robot.begin();
}

void loop() {
  robot.update();
  if (millis() - moved_ms < 250) return;
  moved_ms += 250;
  robot.plot("angle", angle);
  robot.plot("cm", robot.distance());
  robot.plotEnd();
  if (angle + step < 30 || angle + step > 150) step = -step;
  angle += step;
  robot.look(angle);
}
