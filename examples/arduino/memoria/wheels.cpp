#include "config.h"

#if MODE >= 5

#include "controller.h"
#include "link.h"
#include "motor.h"
#include "wheels.h"

volatile float speedA = 0, speedB = 0;
float wantedA = 0, wantedB = 0;
float appliedA = 0, appliedB = 0;
int pwmA = 0, pwmB = 0;

namespace {

volatile unsigned int edgesA = 0, edgesB = 0;
Controller controllerA(1, 0.001, 0, -(255 - EQUILIBRIUM), 255 - EQUILIBRIUM);
Controller controllerB(1, 0.001, 0, -(255 - EQUILIBRIUM), 255 - EQUILIBRIUM);

void countA() {
  edgesA++;
}

void countB() {
  edgesB++;
}

int sign(float value) {
  return (value > 0) - (value < 0);
}

// Weak: one edge in 50 ms is 3.125 rpm, a coarse step. And the direction is what was commanded last, not measured.
float speedOf(volatile unsigned int &edges, Motor &motor) {
  const unsigned int counted = edges;
  edges = 0;
  if (counted == 0) {
    motor.direction = 0;
    return 0;
  }
  const float rpm = counted * 1000.0 * 60.0 / ((float)EDGES_PER_TURN * TIMER_MS);
  return motor.direction == 1 ? rpm : -rpm;
}

void takeReference(float wanted, float &applied, Motor &motor) {
  const bool turnsRound = sign(wanted) != sign(applied);
  applied = turnsRound && motor.direction != 0 ? 0 : wanted;
}

int driveWheel(Controller &controller, Motor &motor, float applied, float speed) {
  int pwm = controller.output(applied - speed);
  if (applied > 0) {
    motor.direction = 1;
    pwm = constrain(pwm + EQUILIBRIUM, 0, 255);
  } else if (applied < 0) {
    motor.direction = -1;
    pwm = constrain(pwm - EQUILIBRIUM, -255, 0);
  } else {
    pwm = 0;
  }
  motor.drive(pwm);
  return pwm;
}

}  // namespace

// Weak: what the modes hang on this (floating point, sine and cosine, triggers) keeps all other interrupts waiting.
ISR(TIMER1_COMPA_vect) {
  speedA = speedOf(edgesA, motorA);
  speedB = speedOf(edgesB, motorB);
  onTimer();
}

void wheelsBegin() {
  motorA.begin();
  motorB.begin();
  pinMode(PIN_ENCODER_A, INPUT);
  pinMode(PIN_ENCODER_B, INPUT);
  attachInterrupt(digitalPinToInterrupt(PIN_ENCODER_A), countA, CHANGE);
  attachInterrupt(digitalPinToInterrupt(PIN_ENCODER_B), countB, CHANGE);
  noInterrupts();
  // 16 MHz / 256 / 3125 = 20 Hz
  TCCR1A = 0;
  TCCR1B = _BV(WGM12) | _BV(CS12);
  OCR1A = 3125 - 1;
  TCNT1 = 0;
  TIMSK1 = _BV(OCIE1A);
  interrupts();
}

void wheelsStop() {
  motorA.drive(0);
  motorB.drive(0);
}

void takeReferences() {
  takeReference(wantedA, appliedA, motorA);
  takeReference(wantedB, appliedB, motorB);
}

void startTogether() {
  if (appliedA == 0 || appliedB == 0) {
    appliedA = 0;
    appliedB = 0;
  }
}

// Weak: the speeds are read while the interrupt may be writing them, four bytes on an 8-bit machine.
void driveWheels() {
  if (gainsArrived[0]) {
    gainsArrived[0] = false;
    controllerA.setGains(newGains[0].kp, newGains[0].ki, newGains[0].kd);
  }
  if (gainsArrived[1]) {
    gainsArrived[1] = false;
    controllerB.setGains(newGains[1].kp, newGains[1].ki, newGains[1].kd);
  }
  pwmA = driveWheel(controllerA, motorA, appliedA, speedA);
  pwmB = driveWheel(controllerB, motorB, appliedB, speedB);
}

bool wheelsStand() {
  return motorA.direction == 0 && motorB.direction == 0;
}

#endif
