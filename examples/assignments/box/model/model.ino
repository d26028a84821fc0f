// Around a box to a goal: corner by corner by odometry; turn, drive, turn. Each motion slows down before its end.

const int ENABLE[] = {5, 6}, FORWARD[] = {4, 7}, BACKWARD[] = {2, 8}, ENCODER[] = {20, 21};
const float RADIUS_M = 0.0325, BASE_M = 0.10, EDGES_PER_TURN = 384;
const float M_PER_EDGE = 2 * PI * RADIUS_M / EDGES_PER_TURN;
// Beside the box, past it, and the goal itself.
const float SIDE_M = 0.38, BEFORE_M = 0.30, PAST_M = 1.30;
const int DEAD_ZONE = 65, CRUISE = 90, LOWEST = 14;
const float PUSH = 0.6;  // PWM more per round while the robot sticks

volatile long edges[2];
volatile int direction[2] = {1, 1};
volatile unsigned long edgeUs[2];
float x = 0, y = 0, heading = 0, push = 0;
long seen[2];
float cornerX[4], cornerY[4];
int corner = 4;
char line[40];
byte length = 0;

void edgeRight() {
  edges[0] += direction[0];
  edgeUs[0] = micros();
}

void edgeLeft() {
  edges[1] += direction[1];
  edgeUs[1] = micros();
}

// The encoder does not tell the direction: a wheel stands before it turns the other way.
bool stands(int number) {
  noInterrupts();
  unsigned long us = edgeUs[number];
  interrupts();
  return micros() - us > 60000;
}

void wheel(int number, int pwm) {
  int sign = pwm < 0 ? -1 : 1;
  if (pwm != 0 && sign != direction[number]) {
    if (stands(number)) direction[number] = sign;
    else pwm = 0;
  }
  digitalWrite(FORWARD[number], pwm > 0);
  digitalWrite(BACKWARD[number], pwm < 0);
  analogWrite(ENABLE[number], min(abs(pwm), 255));
}

void odometry() {
  noInterrupts();
  long right = edges[0], left = edges[1];
  interrupts();
  float r = (right - seen[0]) * M_PER_EDGE, l = (left - seen[1]) * M_PER_EDGE;
  seen[0] = right;
  seen[1] = left;
  heading += (r - l) / BASE_M;
  x += (r + l) / 2 * cos(heading);
  y += (r + l) / 2 * sin(heading);
}

float within(float angle) {
  while (angle > PI) angle -= 2 * PI;
  while (angle < -PI) angle += 2 * PI;
  return angle;
}

enum Phase { TURN, DRIVE } phase = TURN;

void stop() {
  wheel(0, 0);
  wheel(1, 0);
}

// One step on the way to a corner: turn, stand, drive, stand. True when it is there.
bool goTo(float toX, float toY) {
  static bool over = false;
  if (over) {
    stop();
    if (!stands(0) || !stands(1)) return false;
    over = false;
    phase = phase == TURN ? DRIVE : TURN;
    return phase == TURN;
  }
  push = stands(0) || stands(1) ? min(push + PUSH, 60) : 0;
  float away = hypot(toX - x, toY - y);
  float turn = within(atan2(toY - y, toX - x) - heading);
  if (phase == TURN) {
    over = abs(turn) < 0.08;
    float pwm = DEAD_ZONE + push + constrain(30 * abs(turn), LOWEST, 30);
    wheel(0, turn > 0 ? pwm : -pwm);
    wheel(1, turn > 0 ? -pwm : pwm);
  } else {
    // The last centimetres it rolls; beside the corner there is nothing more to drive to.
    over = away < 0.03 || abs(turn) > 1.2;
    float pwm = DEAD_ZONE + push + constrain(200 * away, LOWEST, CRUISE);
    float steer = constrain(60 * turn, -25, 25);
    wheel(0, pwm + steer);
    wheel(1, pwm - steer);
  }
  return false;
}

void obey() {
  if (strncmp(line, "GOAL ", 5)) return;
  char *rest = line + 5;
  float goalX = strtod(rest, &rest), goalY = strtod(rest, NULL);
  float xs[] = {BEFORE_M, PAST_M, goalX}, ys[] = {SIDE_M, SIDE_M, goalY};
  for (int i = 0; i < 3; i++) {
    cornerX[i] = xs[i];
    cornerY[i] = ys[i];
  }
}

void listen() {
  while (Serial2.available()) {
    char c = Serial2.read();
    if (c == '\n') {
      line[length] = 0;
      length = 0;
      if (!strcmp(line, "ON")) corner = 0;
      obey();
    } else if (length < sizeof line - 1) {
      line[length++] = c;
    }
  }
}

void setup() {
  for (int number = 0; number < 2; number++) {
    pinMode(ENABLE[number], OUTPUT);
    pinMode(FORWARD[number], OUTPUT);
    pinMode(BACKWARD[number], OUTPUT);
  }
  attachInterrupt(digitalPinToInterrupt(ENCODER[0]), edgeRight, CHANGE);
  attachInterrupt(digitalPinToInterrupt(ENCODER[1]), edgeLeft, CHANGE);
  Serial2.begin(9600);
}

void loop() {
  listen();
  odometry();
  if (corner < 3) {
    if (goTo(cornerX[corner], cornerY[corner])) corner++;
  } else {
    stop();
  }
  delay(10);
}
