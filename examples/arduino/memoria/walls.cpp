// Modes 1 to 4: distance to a wall, measured by sonars that are polled (sections 2 and 3 of the report).
//
// 1, 2: distance [cm] -> PWM of both wheels, a controller for far and one for near; a positive output drives away from
//       the wall. 2 also: angle to the wall [deg] -> more PWM for one wheel.
// 3, 4: distance [cm] -> angle [deg] -> more PWM for one wheel, while both drive on.

#include "config.h"

#if MODE <= 4

#include "controller.h"
#include "link.h"
#include "modes.h"
#include "motor.h"

#if MODE == 1
const int SONARS = 1;
#else
const int SONARS = 2;
#endif

const float US_PER_CM = 292.0 / 10.0 * 2.0;
const int PAUSE_MS = 60;  // the maker's advice between two shots

#if MODE <= 2
const float SWITCH_CM = 5;
const float GAP_CM = 12;  // between the two sonars
// Weak: these controllers sum errors on while their output is at its limit.
Controller distanceFar(1.5, 0, 0, -50, 50, false);
Controller orientation(1, 0.001, 0, -10, 10, false);
#if MODE == 1
Controller distanceNear(1, 0.0001, 0, -50, 50, false);
#else
Controller distanceNear(3, 0.0001, 0, -50, 50, false);
#endif
#else
const int CRUISE = 25;  // PWM above the equilibrium
const float GAP_CM = 14;
Controller distanceToAngle(1, 0.00005, 0, -10, 10);
Controller orientation(1, 0.0005, 0, -40, 40);
#endif

float cmA, cmB;     // readings
float distanceCm;   // of the middle between the sonars
float thetaDeg;     // angle to the wall, positive if the left (2) or the front (3, 4) sonar is farther away

// Weak: pulseIn() waits, up to 0.7 s if no echo comes, and then says 0: a wall that touches the robot. No reading is
// too absurd to be believed.
float readSonar(int trigger, int echo) {
  digitalWrite(trigger, LOW);
  delayMicroseconds(4);
  digitalWrite(trigger, HIGH);
  delayMicroseconds(10);
  digitalWrite(trigger, LOW);
  return pulseIn(echo, HIGH) / US_PER_CM;
}

// Weak: the second sonar is fired right after the first one's echo, and may hear it come back a second time.
void measure() {
  cmA = readSonar(PIN_TRIGGER_A, PIN_ECHO_A);
  if (SONARS == 1) {
    cmB = cmA;
    distanceCm = cmA;
    return;
  }
  cmB = readSonar(PIN_TRIGGER_B, PIN_ECHO_B);
#if MODE == 2
  const float theta = atan((cmB - cmA) / GAP_CM);
  // Weak: equal readings leave the old distance, and at negative angles the half gap counts with the wrong sign.
  if (cmA != cmB) {
    distanceCm = max(cmA, cmB) * cos(theta) - GAP_CM / 2 * sin(theta);
  }
#else
  const float theta = atan((cmA - cmB) / GAP_CM);
  distanceCm = (cmA + cmB) / 2 * cos(theta);
#endif
  thetaDeg = theta * 180 / PI;
}

// A signal around the equilibrium on a motor; the PWM that it got. `ahead` says where a positive signal drives to.
int apply(Motor &motor, int signal, int ahead) {
  const int QUIET = MODE == 2 ? 2 : 0;  // no larger, and the motor is released
  const int pwm = abs(signal) <= QUIET ? 0 : abs(signal) + EQUILIBRIUM;
  motor.drive(signal > 0 ? ahead * pwm : -ahead * pwm);
  return pwm;
}

// The extra goes to the wheel that it makes faster.
void applyBoth(int signal, int extra, int ahead, int &pwmA, int &pwmB) {
  if ((extra > 0 && signal >= 0) || (extra < 0 && signal < 0)) {
    pwmA = apply(motorA, signal, ahead);
    pwmB = apply(motorB, signal + extra, ahead);
  } else {
    pwmA = apply(motorA, signal - extra, ahead);
    pwmB = apply(motorB, signal, ahead);
  }
}

#if MODE <= 2

// One controller for far, one for near; the other one forgets.
int controlDistance(float errorCm) {
  if (abs(errorCm) > SWITCH_CM) {
    distanceNear.reset();
    return distanceFar.output(errorCm);
  }
  distanceFar.reset();
  return distanceNear.output(errorCm);
}

void control(int &pwmA, int &pwmB) {
  const int signal = controlDistance((int)referenceA - distanceCm);
  const int extra = SONARS == 1 ? 0 : orientation.output(0 - thetaDeg);
  applyBoth(signal, extra, -1, pwmA, pwmB);
}

#else

void control(int &pwmA, int &pwmB) {
  const int angleDeg = distanceToAngle.output(referenceA - distanceCm);
  const int extra = orientation.output(angleDeg - thetaDeg);
  applyBoth(CRUISE, extra, 1, pwmA, pwmB);
}

#endif

#if MODE == 3

// The distance to keep: the median of the first five.
void chooseReference() {
  const int COUNT = 5;
  float readings[COUNT];
  for (int i = 0; i < COUNT; i++) {
    measure();
    int at = i;
    for (; at > 0 && readings[at - 1] > distanceCm; at--) {
      readings[at] = readings[at - 1];
    }
    readings[at] = distanceCm;
    delay(PAUSE_MS);
  }
  referenceA = readings[COUNT / 2];
}

#endif

void modeSetup() {
  motorA.begin();
  motorB.begin();
  pinMode(PIN_TRIGGER_A, OUTPUT);
  pinMode(PIN_ECHO_A, INPUT);
  if (SONARS == 2) {
    pinMode(PIN_TRIGGER_B, OUTPUT);
    pinMode(PIN_ECHO_B, INPUT);
  }
}

void modeStop() {
  motorA.drive(0);
  motorB.drive(0);
}

void modeLoop() {
#if MODE == 3
  static bool chosen = false;
  if (!chosen) {
    chooseReference();
    chosen = true;
  }
#endif
  int pwmA, pwmB;
  measure();
  control(pwmA, pwmB);
  tellPeriod();
#if MODE == 2
  tell(cmB);
  tell(cmA);
#else
  tell(cmA);
  tell(cmB);
#endif
  if (MODE == 3) {
    tell(referenceA);
  } else {
    tell((int)referenceA);
  }
  tell(MODE);
  tell(pwmA);
  tellLast(pwmB);
  delay(PAUSE_MS);
}

#endif
