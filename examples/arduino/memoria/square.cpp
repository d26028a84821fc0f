// Mode 7: round a square of 1 m, corner by corner: turn, then drive (section 5 of the report).

#include "config.h"

#if MODE == 7

#include "link.h"
#include "modes.h"
#include "pose.h"
#include "wheels.h"

enum State { CHOOSE, TURN, DRIVE };

const float ARRIVED_M = 0.1;
const int CORNERS = 4;
const float cornerX[CORNERS] = {1, 1, 0, 0};
const float cornerY[CORNERS] = {0, 1, 1, 0};

State state = CHOOSE;
int corner = CORNERS - 1;  // the one driven to
float angleDeg = 0;

void onTimer() {
  updatePose();
}

// The direction from the last corner to the next. Weak: where the robot really stands does not count.
void choose() {
  const int last = corner;
  corner = (corner + 1) % CORNERS;
  angleDeg = atan2(cornerY[corner] - cornerY[last], cornerX[corner] - cornerX[last]) * 180 / PI;
  angleDeg = wrapped(angleDeg);
  state = TURN;
}

void drive() {
  const float x = cornerX[corner], y = cornerY[corner];
  const float distance = distanceM(x, y);
  if (distance > ARRIVED_M) {
    angleDeg = bearingDeg(x, y);
  }
  const float rpm = distanceController.output(0 - distance);
  driveAt(rpm, angleDeg);
  // The correction once more on the wheel that it speeds up.
  const float correction = wantedA - wantedB;
  wantedA += max(correction, 0.0f);
  wantedB += max(-correction, 0.0f);
  if (distance < ARRIVED_M) {
    orientation.reset();
    state = CHOOSE;
  }
}

void modeSetup() {
  wheelsBegin();
}

void modeStop() {
  wheelsStop();
}

void modeLoop() {
  switch (state) {
    case CHOOSE:
      choose();
      break;
    case TURN:
      if (turnTo(angleDeg)) {
        state = DRIVE;
      }
      break;
    case DRIVE:
      drive();
      break;
  }
  takeReferences();
  startTogether();
  driveWheels();
  tellPeriod();
  tell((float)speedA);
  tell((float)speedB);
  tell(appliedA);
  tell(appliedB);
  tell((float)pose.x);
  tell((float)pose.y);
  tell((float)pose.angleDeg);
  tell(pwmA);
  tellLast(pwmB);
}

#endif
