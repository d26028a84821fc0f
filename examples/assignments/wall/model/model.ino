// Stops at a distance from a wall: PWM in proportion to the error, less for the speed, above the motors' dead zone.

const int ENABLE[] = {5, 6}, FORWARD[] = {4, 7}, BACKWARD[] = {2, 8};
const int TRIGGER = 12, ECHO = 13;
const float CM_PER_US = 0.0343 / 2;
const float GAIN = 1.5;      // PWM per cm
const float DAMPING = 26;    // PWM per cm that the last round brought nearer
const int DEAD_ZONE = 66;    // PWM below which the wheels stand
const int MOST = 110;        // PWM
const float NEAR_CM = 0.8;   // near enough to stand

const float PUSH = 0.5;      // PWM more per round where the robot sticks near its place

bool on = false;
float push = 0;
float lastCm = 0;
float wantedCm = 30;
char line[32];
byte length = 0;

void drive(int pwm) {
  for (int wheel = 0; wheel < 2; wheel++) {
    digitalWrite(FORWARD[wheel], pwm > 0);
    digitalWrite(BACKWARD[wheel], pwm < 0);
    analogWrite(ENABLE[wheel], abs(pwm));
  }
}

float distanceCm() {
  digitalWrite(TRIGGER, HIGH);
  delayMicroseconds(10);
  digitalWrite(TRIGGER, LOW);
  return pulseIn(ECHO, HIGH, 20000) * CM_PER_US;
}

void obey() {
  if (!strcmp(line, "ON")) on = true;
  if (!strcmp(line, "OFF")) on = false;
  if (!strncmp(line, "REF ", 4)) wantedCm = atof(line + 4);
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
  pinMode(TRIGGER, OUTPUT);
  Serial1.begin(9600);
}

void loop() {
  listen();
  float cm = distanceCm();
  float error = cm - wantedCm;
  float nearer = constrain(lastCm - cm, -2, 2);
  lastCm = cm;
  int pwm = 0;
  if (on && cm > 0 && abs(error) > NEAR_CM) {
    push = abs(error) < 10 ? min(push + PUSH, 25) : 0;
    float wanted = GAIN * error - DAMPING * nearer + (error > 0 ? DEAD_ZONE + push : -DEAD_ZONE - push);
    pwm = constrain(wanted, -MOST, MOST);
  } else {
    push = 0;
  }
  drive(pwm);
  delay(20);
}
