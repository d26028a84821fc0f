// Modes 7 and 8: where the robot is, by odometry, and the controllers that bring it elsewhere (section 5 of the report).

#pragma once

#include "controller.h"

struct Pose {
  float x, y;      // m
  float angleDeg;  // (-180, 180]
};

extern volatile Pose pose;

// Distance to a point [m], negative -> speed [rpm].
extern Controller distanceController;
// Angle [deg] -> difference of the wheels' speeds [rpm].
extern Controller orientation;

// 50 ms of the wheels' speeds. For the timer's interrupt.
void updatePose();
void resetPose();

float bearingDeg(float x, float y);
float distanceM(float x, float y);

// An angle that is at most a turn outside of (-180, 180].
float wrapped(float deg);

// Turns about the centre; true when within 5 degrees of an angle and at rest.
bool turnTo(float angleDeg);

// Drives at a speed [rpm], holding an angle.
void driveAt(float rpm, float angleDeg);
