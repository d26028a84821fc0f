#include "controller.h"

#include <Arduino.h>

Controller::Controller(float kp, float ki, float kd, int least, int most, bool antiWindup)
    : kp(kp), ki(ki), kd(kd), least(least), most(most), antiWindup(antiWindup) {
  reset();
}

void Controller::setGains(float newKp, float newKi, float newKd) {
  kp = newKp;
  ki = newKi;
  kd = newKd;
}

void Controller::reset() {
  lastMs = 0;
  lastError = 0;
  sum = 0;
  first = true;
}

// Weak: the gains hold for the period that the loop happens to have. A longer line of telemetry, or a delay(), makes
// other gains of them. And what is smaller than half a step is rounded away.
int Controller::output(float error) {
  const unsigned long nowMs = millis();
  const float passedMs = nowMs - lastMs;
  float added = 0, slope = 0;
  if (!first) {
    added = error * passedMs;
    // Two calls within a millisecond must not divide by zero.
    slope = (error - lastError) / max(passedMs, 1.0f);
  }
  first = false;
  sum += added;
  float result = round(kp * error + ki * sum + kd * slope);
  if (result > most || result < least) {
    if (antiWindup) {
      sum -= added;
    }
    result = constrain(result, least, most);
  }
  lastError = error;
  lastMs = nowMs;
  return result;
}
