// Modes 5 to 8: both wheels at a commanded speed (section 4.1 of the report). Encoders by interrupt, a timer of 50 ms.

#pragma once

const int TIMER_MS = 50;

extern volatile float speedA, speedB;  // rpm
extern float wantedA, wantedB;         // rpm, as the mode wants it
extern float appliedA, appliedB;       // rpm, as the controllers get it
extern int pwmA, pwmB;

void wheelsBegin();
void wheelsStop();

// A reference that changes its sign is zero until the wheel stands.
void takeReferences();

// While one wheel waits at zero, so does the other: both start together.
void startTogether();

// The speed controllers, and the motors.
void driveWheels();

// Neither wheel has turned in the last 50 ms.
bool wheelsStand();

// What else a mode does in the timer's interrupt.
void onTimer();
