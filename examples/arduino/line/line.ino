// Follows a dark line. The Elegoo car V3: rumbo run free --robot kit_elegoo_v3 --world line_loop --sketch example:line
// Bridge: left wheel enable 5 (PWM), forward 7, backward 8; right wheel enable 6 (PWM), forward 11, backward 9.
// Line sensors, LOW over the line: left 2, middle 4, right 10. Serial is the USB cable.
const int ENABLE[] = {5, 6}, FORWARD[] = {7, 11}, BACKWARD[] = {8, 9};
const int LEFT = 2, MIDDLE = 4, RIGHT = 10;
const int CRUISE = 90, BACK = -60;  // PWM: below 80 a wheel that stands does not turn

int side = 0;  // where the line is: 1 left, -1 right

void wheel(int which, int pwm) {  // -255 to 255
  digitalWrite(FORWARD[which], pwm > 0);
  digitalWrite(BACKWARD[which], pwm < 0);
  analogWrite(ENABLE[which], abs(pwm));
}

void setup() {
  const int OUTPUTS[] = {5, 6, 7, 8, 9, 11};
  for (int pin : OUTPUTS) pinMode(pin, OUTPUT);
  Serial.begin(9600);
}

void loop() {
  if (digitalRead(LEFT) == LOW) side = 1;
  else if (digitalRead(RIGHT) == LOW) side = -1;
  else if (digitalRead(MIDDLE) == LOW) side = 0;
  // If no sensor sees it, it is where it went.
  wheel(0, side > 0 ? BACK : CRUISE);
  wheel(1, side < 0 ? BACK : CRUISE);
  Serial.println(side);
  delay(10);
}
