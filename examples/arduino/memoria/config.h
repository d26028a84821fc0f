// Which program this is, and which pin is what. Motor A is the right wheel, motor B the left one.

#pragma once

#include <Arduino.h>

// 1 stop at a wall, 2 the same and square to it, 3 along a wall, 4 the same at a distance that may be changed,
// 5 wheel speeds, 6 straight on, 7 a square of 1 m, 8 a goal behind obstacles.
#ifndef MODE
#define MODE 1
#endif

// With mode 8: follow a lane of boxes instead of going to goals.
#ifndef LANE
#define LANE 0
#endif

const int PIN_ENA = 5;
const int PIN_IN1 = 2;  // A backward
const int PIN_IN2 = 4;  // A forward
const int PIN_ENB = 6;
const int PIN_IN3 = 8;  // B backward
const int PIN_IN4 = 7;  // B forward

#if MODE <= 4
// One sonar (A) in front for mode 1; a pair in front for mode 2 (A right, B left), on the left for modes 3 and 4 (B behind A).
const int PIN_TRIGGER_A = 12;
const int PIN_ECHO_A = 13;
const int PIN_TRIGGER_B = 15;
const int PIN_ECHO_B = 14;
#else
const int PIN_ENCODER_A = 20;
const int PIN_ENCODER_B = 21;
#endif

#if MODE == 8
// The final build: echoes on interrupt pins, the front sonar on a servo, Bluetooth on the third serial port.
const int PIN_TRIGGER_RIGHT = 12;
const int PIN_ECHO_RIGHT = 18;
const int PIN_TRIGGER_LEFT = 15;
const int PIN_ECHO_LEFT = 19;
const int PIN_TRIGGER_FRONT = 14;
const int PIN_ECHO_FRONT = 3;
const int PIN_SERVO = 9;
#define BLUETOOTH Serial2
#else
#define BLUETOOTH Serial1
#endif

const long BLUETOOTH_BAUD = 9600;

// PWM at which the robot just begins to move. Controllers work around it.
#if MODE <= 2
const int EQUILIBRIUM = 65;
#elif MODE <= 4
const int EQUILIBRIUM = 45;
#elif MODE <= 6
const int EQUILIBRIUM = 50;
#else
const int EQUILIBRIUM = 60;
#endif

const float WHEEL_RADIUS_M = 0.0325;
const float WHEEL_BASE_M = 0.10;
// 48 turns of the motor to one of the wheel, 8 edges of the Hall sensor to one of the motor.
const int EDGES_PER_TURN = 48 * 8;
