// The program of the robot in the report: a differential drive on an Arduino Mega, one experiment ("mode") at a time.
//
//   read the sensors -> controllers -> motors -> print a line of telemetry -> again
//
// Which mode is built is chosen in config.h. The robot waits for "ON" on the Bluetooth link; README.md has the rest.

#include "config.h"
#include "link.h"
#include "modes.h"

void setup() {
  linkBegin();
  modeSetup();
}

void loop() {
  linkPoll();
  if (!isOn) {
    modeStop();
    while (!isOn) {
      linkPoll();
    }
  }
  modeLoop();
}
