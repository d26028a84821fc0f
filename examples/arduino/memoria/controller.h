// The PID controller that every loop of every mode uses.

#pragma once

class Controller {
public:
  Controller(float kp, float ki, float kd, int least, int most);
  void setGains(float kp, float ki, float kd);
  void reset();
  // The output for an error, rounded to a whole number.
  int output(float error);

private:
  float kp, ki, kd;  // ki per millisecond, kd in milliseconds
  int least, most;
  unsigned long lastMs;
  float lastError, sum;
  bool first;
};
