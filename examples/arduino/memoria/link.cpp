#include "link.h"

#include "config.h"

bool isOn = false;
#if MODE <= 2
float referenceA = 30, referenceB = 30;
#elif MODE <= 4
float referenceA = 50, referenceB = 50;
#else
float referenceA = 0, referenceB = 0;
#endif
float orderedX = 0, orderedY = 0;
bool goalArrived = false;
Gains newGains[2];
bool gainsArrived[2] = {false, false};

namespace {

char line[48];
byte length = 0;
unsigned long lastLineMs = 0;

float nextNumber() {
  const char *word = strtok(NULL, " ");
  return word ? atof(word) : 0;
}

void setReference() {
  const char *word = strtok(NULL, " ");
  if (!word) {
    return;
  }
  if (*word == 'A') {
    referenceA = nextNumber();
  } else if (*word == 'B') {
    referenceB = nextNumber();
  } else {
    referenceA = referenceB = atof(word);
  }
}

void setGains() {
  const char *word = strtok(NULL, " ");
  if (!word) {
    return;
  }
  const int motor = *word == 'B';
  newGains[motor].kp = nextNumber();
  newGains[motor].ki = nextNumber();
  newGains[motor].kd = nextNumber();
  gainsArrived[motor] = true;
}

void obey() {
  const char *word = strtok(line, " ");
  if (!word) {
    return;
  }
  if (!strcmp(word, "ON")) {
    isOn = true;
  } else if (!strcmp(word, "OFF")) {
    isOn = false;
  } else if (!strcmp(word, "REF")) {
    setReference();
  } else if (!strcmp(word, "GOAL")) {
    orderedX = nextNumber();
    orderedY = nextNumber();
    goalArrived = true;
  } else if (!strcmp(word, "PID")) {
    setGains();
  }
}

}  // namespace

void linkBegin() {
  BLUETOOTH.begin(BLUETOOTH_BAUD);
}

// Weak: nothing notices when the link is lost. The robot goes on with its last command.
void linkPoll() {
  while (BLUETOOTH.available()) {
    const char c = BLUETOOTH.read();
    if (c == '\n') {
      line[length] = '\0';
      length = 0;
      obey();
    } else if (c != '\r' && length < sizeof line - 1) {
      line[length++] = c;
    }
  }
}

// Weak: 960 bytes go out in a second, and the library keeps 64. A line that is longer than what went out since the last
// one makes the program wait, and that is what sets the period of the loop.
void tellPeriod() {
  const unsigned long nowMs = millis();
  tell((int)(nowMs - lastLineMs));
  lastLineMs = nowMs;
}

void tell(float value) {
  BLUETOOTH.print(value);
  BLUETOOTH.print(", ");
}

void tell(int value) {
  BLUETOOTH.print(value);
  BLUETOOTH.print(", ");
}

void tellLast(float value) {
  BLUETOOTH.println(value);
}

void tellLast(int value) {
  BLUETOOTH.println(value);
}
