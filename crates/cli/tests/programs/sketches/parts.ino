void setup() {
  pinMode(8, INPUT_PULLUP); pinMode(4, INPUT);
  for (int pin = 5; pin <= 7; pin++) pinMode(pin, OUTPUT);
  while (digitalRead(8) == HIGH) {}
  tone(11, 440);
  digitalWrite(7, HIGH);
}
void loop() {
  int speed = analogRead(A0) / 4;
  analogWrite(5, digitalRead(4) ? speed : 0);
  digitalWrite(12, digitalRead(4));
}
