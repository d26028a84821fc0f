#include "motor.h"

#include "config.h"

Motor motorA(PIN_ENA, PIN_IN1, PIN_IN2);
Motor motorB(PIN_ENB, PIN_IN3, PIN_IN4);

Motor::Motor(int enable, int backward, int forward)
    : enable(enable), backward(backward), forward(forward) {}

void Motor::begin() {
  pinMode(enable, OUTPUT);
  pinMode(backward, OUTPUT);
  pinMode(forward, OUTPUT);
  drive(0);
}

void Motor::drive(int pwm) {
  digitalWrite(backward, pwm < 0 ? HIGH : LOW);
  digitalWrite(forward, pwm > 0 ? HIGH : LOW);
  analogWrite(enable, min(abs(pwm), 255));
}
