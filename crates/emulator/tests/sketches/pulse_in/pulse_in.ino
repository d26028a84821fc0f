// A sonar, polled: triggered on pin 12, its echo measured with pulseIn on pin 13. Pin 22 is high while it waits.

volatile unsigned long width_us[16];
volatile byte count = 0;

void setup() {
  pinMode(12, OUTPUT);
  pinMode(13, INPUT);
  pinMode(22, OUTPUT);
}

void loop() {
  digitalWrite(12, LOW);
  delayMicroseconds(4);
  digitalWrite(12, HIGH);
  delayMicroseconds(10);
  digitalWrite(12, LOW);
  digitalWrite(22, HIGH);
  unsigned long width = pulseIn(13, HIGH);
  digitalWrite(22, LOW);
  if (count < 16) {
    width_us[count++] = width;
  }
  delay(5);
}
