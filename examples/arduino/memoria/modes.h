// What each mode gives to memoria.ino. One of walls.cpp, speed.cpp, square.cpp and mission.cpp is built.

#pragma once

void modeSetup();

// One pass of the control loop.
void modeLoop();

// Motors off, because of "OFF".
void modeStop();
