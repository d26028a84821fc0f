// The Bluetooth link: commands in, a line of telemetry out. Both are text.
//
// ON, OFF, REF v, REF A v, REF B v, GOAL x y, PID A kp ki kd, PID B kp ki kd. What REF means depends on the mode: cm
// in 1 to 4, rpm in 5 and 6. Gains are those of the wheels' speed controllers, ki per millisecond.

#pragma once

#include <Arduino.h>

extern bool isOn;
extern float referenceA, referenceB;
extern float orderedX, orderedY;  // the goal that came last [m]
extern bool goalArrived;          // since it was last taken

struct Gains {
  float kp, ki, kd;
};

// New gains of motor A and of motor B, and whether they have been used.
extern Gains newGains[2];
extern bool gainsArrived[2];

void linkBegin();

// Reads what has come in; obeys every line that is whole.
void linkPoll();

// The first value of a line, the time since the line before it; then the others; then the last one.
void tellPeriod();
void tell(float value);
void tell(int value);
void tellLast(float value);
void tellLast(int value);
