// analogWrite on every pin of the Mega that has PWM, each with a value of its own: 10 + 5 times its number.

void setup() {
  for (int pin = 2; pin <= 13; pin++) {
    analogWrite(pin, 10 + 5 * pin);
  }
  for (int pin = 44; pin <= 46; pin++) {
    analogWrite(pin, 10 + 5 * pin);
  }
  // The ends of the range are levels, not waves.
  analogWrite(22, 200);
  analogWrite(23, 100);
}

void loop() {
}
