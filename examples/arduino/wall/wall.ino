// Drives to a wall and stops before it, at 30 cm or at what REF says. It keeps the limits of: rumbo run mode1 --sketch example:wall
// Bridge: right wheel enable 5 (PWM), forward 4, backward 2; left wheel enable 6 (PWM), forward 7, backward 8.
// Sonar in front: trigger 12, echo 13. Serial1 (18, 19) is Bluetooth at 9600 baud, Serial the USB cable.
const int ENABLE[] = {5, 6}, FORWARD[] = {4, 7}, BACKWARD[] = {2, 8};
const int TRIGGER = 12, ECHO = 13;
const float GAIN = 7, LEAD = 4;
float goalCm = 30, beforeCm = 0;

void drive(int pwm) {  // -255 to 255, both wheels
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
  return pulseIn(ECHO, HIGH, 30000) / 58.0;  // 0: no echo
}

void setup() {
  const int OUTPUTS[] = {5, 6, 4, 7, 2, 8, TRIGGER};
  for (int pin : OUTPUTS) pinMode(pin, OUTPUT);
  Serial.begin(115200);
  Serial1.begin(9600);
  beforeCm = distanceCm();
}

void loop() {
  if (Serial1.available()) {
    String line = Serial1.readStringUntil('\n');
    if (line.startsWith("REF ")) goalCm = line.substring(4).toFloat();
  }
  float cm = distanceCm();
  // It rolls on: what counts is where it will be in four rounds of this loop.
  float error = cm + LEAD * (cm - beforeCm) - goalCm;
  beforeCm = cm;
  // Below a PWM of about 60 the wheels do not turn.
  int pwm = cm == 0 || abs(error) < 0.5 ? 0 : constrain(GAIN * error + (error > 0 ? 55 : -55), -170, 170);
  drive(pwm);
  Serial.println(cm);
  delay(40);
}
