char letter;
void setup() {
  Serial.begin(9600);
  for (int pin = 5; pin <= 8; pin++) pinMode(pin, OUTPUT);
  digitalWrite(7, HIGH); digitalWrite(8, HIGH);
}
void loop() {
  if (Serial.available()) letter = Serial.read();
  analogWrite(5, letter == 'F' ? 150 : 0);
  analogWrite(6, letter == 'F' ? 150 : 0);
  delay(50);
}
