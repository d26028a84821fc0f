// One half of the L298N and the motor on it.

#pragma once

class Motor {
public:
  Motor(int enable, int backward, int forward);
  void begin();
  // PWM from -255, full speed back, to 255, full speed ahead; 0 lets the wheel roll out.
  void drive(int pwm);

  // For the encoders, which do not tell the direction: 1, -1, or 0 once the wheel stands.
  volatile int direction = 0;

private:
  int enable, backward, forward;
};

extern Motor motorA, motorB;
