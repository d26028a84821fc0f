#include "config.h"

#if MODE >= 7

#include "pose.h"
#include "wheels.h"

const float TURNED_DEG = 5;

volatile Pose pose = {0, 0, 0};
Controller distanceController(-1000, -0.005, 0, -80, 80);
#if MODE == 7
Controller orientation(4, 0.0005, 0, -30, 30);
#else
Controller orientation(1.5, 0.0005, 0, -30, 30);
#endif

void updatePose() {
  const float phi = pose.angleDeg * PI / 180;
  const float left = speedB * 2 * PI / 60 * WHEEL_RADIUS_M;
  const float right = speedA * 2 * PI / 60 * WHEEL_RADIUS_M;
  const float seconds = TIMER_MS / 1000.0;
  pose.x += (left + right) / 2 * cos(phi) * seconds;
  pose.y += (left + right) / 2 * sin(phi) * seconds;
  pose.angleDeg = wrapped(pose.angleDeg + (right - left) / WHEEL_BASE_M * seconds * 180 / PI);
}

void resetPose() {
  pose.x = 0;
  pose.y = 0;
  pose.angleDeg = 0;
}

float bearingDeg(float x, float y) {
  return wrapped(atan2(y - pose.y, x - pose.x) * 180 / PI);
}

float distanceM(float x, float y) {
  return sqrt(square(x - pose.x) + square(y - pose.y));
}

float wrapped(float deg) {
  if (deg > 180) {
    return deg - 360;
  }
  return deg <= -180 ? deg + 360 : deg;
}

bool turnTo(float angleDeg) {
  const float errorDeg = wrapped(angleDeg - pose.angleDeg);
  const int difference = orientation.output(errorDeg);
  wantedA = difference / 2.0;
  wantedB = -difference / 2.0;
  if (abs(errorDeg) >= TURNED_DEG || !wheelsStand()) {
    return false;
  }
  orientation.reset();
  distanceController.reset();
  return true;
}

void driveAt(float rpm, float angleDeg) {
  const int difference = orientation.output(wrapped(angleDeg - pose.angleDeg));
  wantedA = rpm + difference / 2.0;
  wantedB = rpm - difference / 2.0;
}

#endif
