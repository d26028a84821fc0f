// Greets, then sends back what it receives: at 115200 baud on Serial, at 9600 on Serial2.

void setup() {
  Serial.begin(115200);
  Serial2.begin(9600);
  Serial.println("Hello, 115200");
  Serial2.println("Hello, 9600");
}

void loop() {
  if (Serial.available()) {
    Serial.write(Serial.read());
  }
  if (Serial2.available()) {
    Serial2.write(Serial2.read());
  }
}
