// Each wheel at a commanded speed: the speed from the time between edges, feedforward, and a PI with anti-windup.

const int ENABLE[] = {5, 6}, FORWARD[] = {4, 7}, BACKWARD[] = {2, 8}, ENCODER[] = {20, 21};
const float EDGES_PER_TURN = 384;      // both edges
const unsigned long PERIOD_MS = 20;
const float DEAD_ZONE = 45, PWM_PER_RPM = 0.55, KP = 0.6, KI = 2.5;
const float MOST_INTEGRAL = 60;        // PWM
const float NEAR_RPM = 30;             // farther away the integral stands

volatile unsigned int edges[2];
volatile unsigned long edgeUs[2];
unsigned int countedEdges[2];
unsigned long countedUs[2];
float rpm[2], integral[2], wantedRpm[2];
bool on = false;
char line[32];
byte length = 0;

void edgeRight() {
  edges[0]++;
  edgeUs[0] = micros();
}

void edgeLeft() {
  edges[1]++;
  edgeUs[1] = micros();
}

void drive(int wheel, int pwm) {
  digitalWrite(FORWARD[wheel], pwm > 0);
  digitalWrite(BACKWARD[wheel], pwm < 0);
  analogWrite(ENABLE[wheel], abs(pwm));
}

// Speed without a sign: the encoder has one channel.
void measure(int wheel) {
  noInterrupts();
  unsigned int now = edges[wheel];
  unsigned long us = edgeUs[wheel];
  interrupts();
  unsigned int fresh = now - countedEdges[wheel];
  if (fresh > 0) {
    rpm[wheel] = fresh * 60e6 / EDGES_PER_TURN / (us - countedUs[wheel]);
    countedEdges[wheel] = now;
    countedUs[wheel] = us;
  } else if (micros() - us > 60000) {
    rpm[wheel] = 0;
  }
}

void control(int wheel) {
  measure(wheel);
  float wanted = on ? wantedRpm[wheel] : 0;
  int direction = wanted < 0 ? -1 : 1;
  if (wanted == 0) {
    integral[wheel] = 0;
    drive(wheel, 0);
    return;
  }
  float error = abs(wanted) - rpm[wheel];
  if (abs(error) < NEAR_RPM) integral[wheel] += KI * error * PERIOD_MS / 1000.0;
  integral[wheel] = constrain(integral[wheel], -MOST_INTEGRAL, MOST_INTEGRAL);
  float pwm = DEAD_ZONE + PWM_PER_RPM * abs(wanted) + KP * error + integral[wheel];
  drive(wheel, direction * (int)constrain(pwm, 0, 255));
}

void obey() {
  if (!strcmp(line, "ON")) on = true;
  if (!strcmp(line, "OFF")) on = false;
  if (!strncmp(line, "REF A ", 6)) wantedRpm[0] = atof(line + 6);
  else if (!strncmp(line, "REF B ", 6)) wantedRpm[1] = atof(line + 6);
  else if (!strncmp(line, "REF ", 4)) wantedRpm[0] = wantedRpm[1] = atof(line + 4);
}

void listen() {
  while (Serial1.available()) {
    char c = Serial1.read();
    if (c == '\n') {
      line[length] = 0;
      length = 0;
      obey();
    } else if (length < sizeof line - 1) {
      line[length++] = c;
    }
  }
}

void setup() {
  for (int wheel = 0; wheel < 2; wheel++) {
    pinMode(ENABLE[wheel], OUTPUT);
    pinMode(FORWARD[wheel], OUTPUT);
    pinMode(BACKWARD[wheel], OUTPUT);
  }
  attachInterrupt(digitalPinToInterrupt(ENCODER[0]), edgeRight, CHANGE);
  attachInterrupt(digitalPinToInterrupt(ENCODER[1]), edgeLeft, CHANGE);
  Serial1.begin(9600);
}

void loop() {
  static unsigned long next = 0;
  listen();
  if (millis() - next >= PERIOD_MS) {
    next += PERIOD_MS;
    control(0);
    control(1);
  }
}
