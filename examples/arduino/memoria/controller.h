// The PID controller that every loop of every mode uses.

#pragma once

class Controller {
public:
  // Anti-windup: an error that cannot be answered is not summed.
  Controller(float kp, float ki, float kd, int least, int most, bool antiWindup = true);
  void setGains(float kp, float ki, float kd);
  void reset();
  // The output for an error, rounded to a whole number.
  int output(float error);

private:
  float kp, ki, kd;  // ki per millisecond, kd in milliseconds
  int least, most;
  bool antiWindup;
  unsigned long lastMs;
  float lastError, sum;
  bool first;
};
