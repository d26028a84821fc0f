// Mode 8: three sonars, fired every 100 ms by the timer, their echoes timed by interrupts.

#pragma once

extern volatile float rightCm, leftCm, frontCm;

void sonarsBegin();

// Fires all three. For the timer's interrupt.
void fireSonars();

// What mode 8 does when the front sonar has a new reading; in the interrupt.
void onFrontReading();
