volatile long slots;
void slot() { slots++; }
void setup() {
  Serial.begin(115200);
  attachInterrupt(digitalPinToInterrupt(3), slot, FALLING);
  pinMode(5, OUTPUT); pinMode(7, OUTPUT);
  digitalWrite(7, HIGH); analogWrite(5, 200);
  delay(2900); Serial.println(slots);
}
void loop() {}
