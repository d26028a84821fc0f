// Follows a line: a turn in proportion to how far the line is from the middle sensor, and to how fast it goes away.

const int ENABLE[] = {5, 6}, FORWARD[] = {7, 11}, BACKWARD[] = {8, 9};
const int LEFT = 2, MIDDLE = 4, RIGHT = 10;
const int PERIOD_MS = 10;
const int CRUISE = 84;        // PWM: just enough for the wheels to turn
const float GAIN = 1.2;       // PWM per mm
const float DAMPING = 0.15;   // PWM per mm/s
const float FRESH = 0.15;     // share of the newest slope: the sensors tell steps
const float LOST_MM = 30;

float lineMm = 0;             // where the line is, to the left of the middle sensor
float slopeMmS = 0;
unsigned long lastMs = 0;

void wheel(int which, int pwm) {
  digitalWrite(FORWARD[which], pwm > 0);
  digitalWrite(BACKWARD[which], pwm < 0);
  analogWrite(ENABLE[which], min(abs(pwm), 255));
}

bool dark(int pin) { return digitalRead(pin) == LOW; }

// The sensors are 15 mm apart, the line is 19 mm wide: between two of them it is below both.
float look() {
  bool left = dark(LEFT), middle = dark(MIDDLE), right = dark(RIGHT);
  if (left) return middle ? 7.5 : 15;
  if (right) return middle ? -7.5 : -15;
  if (middle) return 0;
  return lineMm > 0 ? LOST_MM : -LOST_MM;  // it went out on that side
}

void setup() {
  for (int which = 0; which < 2; which++) {
    pinMode(ENABLE[which], OUTPUT);
    pinMode(FORWARD[which], OUTPUT);
    pinMode(BACKWARD[which], OUTPUT);
  }
}

void loop() {
  if (millis() - lastMs < PERIOD_MS) return;
  lastMs += PERIOD_MS;
  float before = lineMm;
  lineMm = look();
  slopeMmS += FRESH * ((lineMm - before) * 1000 / PERIOD_MS - slopeMmS);
  int turn = GAIN * lineMm + DAMPING * slopeMmS;
  wheel(0, CRUISE - turn);
  wheel(1, CRUISE + turn);
}
