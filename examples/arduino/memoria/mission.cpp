// Mode 8: to a goal around obstacles, or along a lane of boxes (section 6 of the report).
//
// GO towards the goal. Something 25 cm ahead: SWEEP the front sonar to the right and to the left until the range jumps,
// turn to the side with the smaller angle, SEEK the obstacle with the side sonar, drive ALONG it until it ends, PASS the
// corner, turn back, and so on round it. Where the bearing of the goal is that of the straight line again, leave for it.
// The lane: straight on (SEEK), sweep, turn, for ever.

#include "config.h"

#if MODE == 8

#include <Servo.h>

#include "link.h"
#include "modes.h"
#include "motor.h"
#include "pose.h"
#include "sonars.h"
#include "wheels.h"

enum State {
  WAIT, FIRST_TURN, INITIALISE, GO, SWEEP_RIGHT, SWEEP_LEFT, DECIDE, TURN, SEEK, ALONG, PASS
};

const float ARRIVED_M = 0.05;
const float SAFE_CM = 25;
const float JUMP_CM = 30;
const float REJOIN_DEG = 1;
const int SWEEP_STEP_DEG = 3;
const int SWEEP_END_DEG = 90;
const int SWEEP_STEP_MS = 300;
const int AHEAD_DEG = 90;  // of the servo; less is right
const float CRUISE_RPM = 50;

Servo eye;
volatile State state = LANE ? SEEK : WAIT;
volatile bool watching = LANE;  // something ahead starts a sweep
float goalX = 0, goalY = 0;     // m
float angleDeg = 0;             // to hold, or to turn to
float lineDeg = 0;              // of the straight line to the goal
float cornerX, cornerY;
bool turnedRight = false;  // the obstacle is on the left then
bool leftTheLine = false;
int sweptRight = 0, sweptLeft = 0;
volatile float lastCm = SAFE_CM;

void startSweep(int &swept) {
  eye.write(AHEAD_DEG);
  lastCm = SAFE_CM;
  swept = 0;
}

void onTimer() {
  static bool fire = true;
  updatePose();
  if (fire) {
    fireSonars();
  }
  fire = !fire;
}

// Weak: the loop may be changing the same things at this moment. A sweep that starts while the loop is about to enter
// another state is forgotten.
void onFrontReading() {
  if (isOn && watching && frontCm <= SAFE_CM) {
    watching = false;
    orientation.reset();
    wantedA = 0;
    wantedB = 0;
    startSweep(sweptRight);
    state = SWEEP_RIGHT;
  }
}

// A goal that comes while the robot is on its way has to wait for the end of it.
void waitForGoal() {
  wheelsStop();
  resetPose();
  while (isOn && !goalArrived) {
    linkPoll();
  }
  if (goalArrived) {
    goalArrived = false;
    goalX = orderedX;
    goalY = orderedY;
    state = INITIALISE;
  }
}

void go() {
  const float distance = distanceM(goalX, goalY);
  angleDeg = bearingDeg(goalX, goalY);
  driveAt(distanceController.output(0 - distance), angleDeg);
  if (distance < ARRIVED_M) {
    watching = false;
    orientation.reset();
    wantedA = 0;
    wantedB = 0;
    state = WAIT;
  }
}

// Weak: at each step everything sleeps for 300 ms, also the wheels' controllers. When a sweep starts, the robot drives on.
void sweep(int &swept, int side) {
  if (abs(frontCm - lastCm) <= JUMP_CM && swept < SWEEP_END_DEG) {
    swept += SWEEP_STEP_DEG;
    eye.write(AHEAD_DEG + side * swept);
    lastCm = frontCm;
  } else if (state == SWEEP_RIGHT) {
    startSweep(sweptLeft);
    delay(SWEEP_STEP_MS);
    state = SWEEP_LEFT;
  } else {
    eye.write(AHEAD_DEG);
    state = DECIDE;
  }
  delay(SWEEP_STEP_MS);
}

void decide() {
  turnedRight = sweptRight <= sweptLeft;
  angleDeg = wrapped(pose.angleDeg + (turnedRight ? -90 : 90));
  state = TURN;
}

// The sonar on the obstacle's side sees it.
bool isBeside() {
  return (turnedRight ? leftCm : rightCm) < SAFE_CM + JUMP_CM;
}

// On the straight line to the goal again? Then leave for it.
// Weak: looked at once in some 85 ms and only 1 degree wide, it can be missed; and the difference does not wrap.
bool isOnLine() {
  if (LANE || abs(bearingDeg(goalX, goalY) - lineDeg) > REJOIN_DEG) {
    return false;
  }
  if (leftTheLine) {
    orientation.reset();
    state = FIRST_TURN;
  }
  return true;
}

void along() {
  driveAt(CRUISE_RPM, angleDeg);
  if (isOnLine()) {
    return;
  }
  leftTheLine = true;
  if (!isBeside()) {
    cornerX = pose.x;
    cornerY = pose.y;
    state = PASS;
  }
}

void pass() {
  const float wayM = 0.5 * SAFE_CM * 0.01;
  const float goneM = distanceM(cornerX, cornerY);
  driveAt(distanceController.output(goneM - wayM), angleDeg);
  if (!isOnLine() && goneM >= wayM) {
    orientation.reset();
    distanceController.reset();
    wantedA = 0;
    wantedB = 0;
    angleDeg = wrapped(pose.angleDeg + (turnedRight ? 90 : -90));
    state = TURN;
  }
}

void step() {
  switch (state) {
    case WAIT:
      waitForGoal();
      break;
    case INITIALISE:
      eye.write(AHEAD_DEG);
      lineDeg = bearingDeg(goalX, goalY);
      state = FIRST_TURN;
      break;
    case FIRST_TURN:
      if (turnTo(lineDeg)) {
        leftTheLine = false;
        watching = true;
        state = GO;
      }
      break;
    case GO:
      go();
      break;
    case SWEEP_RIGHT:
      sweep(sweptRight, -1);
      break;
    case SWEEP_LEFT:
      sweep(sweptLeft, 1);
      break;
    case DECIDE:
      decide();
      break;
    case TURN:
      if (turnTo(angleDeg)) {
        wantedA = 0;
        wantedB = 0;
        watching = true;
        state = SEEK;
      }
      break;
    case SEEK:
      if (!LANE && isBeside()) {
        state = ALONG;
      } else {
        driveAt(CRUISE_RPM, angleDeg);
      }
      isOnLine();
      break;
    case ALONG:
      along();
      break;
    case PASS:
      pass();
      break;
  }
}

// The number of the state in the telemetry; a lane has numbers of its own.
int stateNumber() {
  if (!LANE) {
    return state;
  }
  switch (state) {
    case SWEEP_RIGHT: return 1;
    case SWEEP_LEFT: return 2;
    case DECIDE: return 3;
    case TURN: return 4;
    default: return 0;
  }
}

void modeSetup() {
  wheelsBegin();
  sonarsBegin();
  eye.attach(PIN_SERVO);
  eye.write(AHEAD_DEG);
}

void modeStop() {
  wheelsStop();
}

void modeLoop() {
  step();
  takeReferences();
  startTogether();
  driveWheels();
  tellPeriod();
  tell(appliedA);
  tell(appliedB);
  tell(angleDeg);
  tell(goalX);
  tell(goalY);
  tell((float)pose.x);
  tell((float)pose.y);
  tell((float)pose.angleDeg);
  tell(stateNumber());
  tell((float)rightCm);
  tell((float)leftCm);
  tellLast((float)frontCm);
}

#endif
