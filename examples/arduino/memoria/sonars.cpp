#include "config.h"

#if MODE == 8

#include "sonars.h"

volatile float rightCm = 0, leftCm = 0, frontCm = 0;

namespace {

const float US_PER_CM = 58;

struct Echo {
  bool high;
  unsigned long riseUs;
};

volatile Echo echoRight, echoLeft, echoFront;

// An edge of an echo line; true when the echo is over and `cm` is new.
// Weak: it takes edges for alternating. If one is lost, the pause between echoes is measured from then on.
bool edge(volatile Echo &echo, volatile float &cm) {
  const unsigned long nowUs = micros();
  echo.high = !echo.high;
  if (echo.high) {
    echo.riseUs = nowUs;
    return false;
  }
  cm = (nowUs - echo.riseUs) / US_PER_CM;
  return true;
}

void edgeRight() {
  edge(echoRight, rightCm);
}

void edgeLeft() {
  edge(echoLeft, leftCm);
}

void edgeFront() {
  if (edge(echoFront, frontCm)) {
    onFrontReading();
  }
}

void fire(int trigger) {
  digitalWrite(trigger, LOW);
  delayMicroseconds(4);
  digitalWrite(trigger, HIGH);
  delayMicroseconds(10);
  digitalWrite(trigger, LOW);
}

}  // namespace

void sonarsBegin() {
  pinMode(PIN_TRIGGER_RIGHT, OUTPUT);
  pinMode(PIN_TRIGGER_LEFT, OUTPUT);
  pinMode(PIN_TRIGGER_FRONT, OUTPUT);
  pinMode(PIN_ECHO_RIGHT, INPUT);
  pinMode(PIN_ECHO_LEFT, INPUT);
  pinMode(PIN_ECHO_FRONT, INPUT);
  attachInterrupt(digitalPinToInterrupt(PIN_ECHO_RIGHT), edgeRight, CHANGE);
  attachInterrupt(digitalPinToInterrupt(PIN_ECHO_LEFT), edgeLeft, CHANGE);
  attachInterrupt(digitalPinToInterrupt(PIN_ECHO_FRONT), edgeFront, CHANGE);
}

// Weak: all at once, so that one may hear another's echo.
void fireSonars() {
  fire(PIN_TRIGGER_RIGHT);
  fire(PIN_TRIGGER_LEFT);
  fire(PIN_TRIGGER_FRONT);
}

#endif
