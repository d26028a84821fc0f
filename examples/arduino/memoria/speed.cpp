// Modes 5 and 6: both wheels at a speed; straight on by the difference of the ways travelled (section 4 of the report).

#include "config.h"

#if MODE == 5 || MODE == 6

#include "controller.h"
#include "link.h"
#include "modes.h"
#include "wheels.h"

#if MODE == 6
// Difference [m] -> more speed for the wheel that is behind [rpm].
// Weak: the output is a whole number, so that it feels nothing below 5 mm.
Controller straightLine(100, 0.000001, 0, -5, 5);
volatile float travelledA = 0, travelledB = 0;  // m
#endif

void onTimer() {
#if MODE == 6
  const float METRES_PER_RPM = 2 * PI / 60 * WHEEL_RADIUS_M * TIMER_MS / 1000;
  travelledA += speedA * METRES_PER_RPM;
  travelledB += speedB * METRES_PER_RPM;
#endif
}

#if MODE == 6
void steer() {
  if (appliedA == 0) {
    return;
  }
  const int extra = straightLine.output(0 - (travelledA - travelledB));
  const int ahead = referenceA > 0 ? 1 : -1;
  if (extra < 0) {
    appliedB += ahead * -extra;
  } else {
    appliedA += ahead * extra;
  }
}
#endif

void modeSetup() {
  wheelsBegin();
}

void modeStop() {
  wheelsStop();
}

void modeLoop() {
  wantedA = referenceA;
  wantedB = referenceB;
  takeReferences();
#if MODE == 6
  steer();
#endif
  driveWheels();
  tellPeriod();
  tell((float)speedA);
  tell((float)speedB);
  tell(appliedA);
  tell(MODE);
  tell(pwmA);
  tellLast(pwmB);
}

#endif
