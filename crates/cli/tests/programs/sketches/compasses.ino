// Prints where both compasses point, clockwise from north, before and after a turn on the spot.
float azimuth(byte at, byte low, byte x, byte y) {
  float sums[2] = {0, 0};
  for (byte n = 0; n < 40; n++) {
    byte bytes[6];
    start(at << 1); send(low); start(at << 1 | 1);
    for (byte i = 0; i < 6; i++) bytes[i] = receive(i < 5);
    stop();
    byte high = at == 0x0D;
    sums[0] += (int)(bytes[x + high] << 8 | bytes[x + 1 - high]);
    sums[1] += (int)(bytes[y + high] << 8 | bytes[y + 1 - high]);
    delay(6);
  }
  float degrees = atan2(sums[1], sums[0]) * 57.2958;
  return degrees < 0 ? degrees + 360 : degrees;
}
void tell() { Serial.println(azimuth(0x0D, 0, 0, 2)); Serial.println(azimuth(0x1E, 3, 0, 4)); }
void setup() {
  Serial.begin(115200);
  TWBR = 12;
  for (byte pin = 5; pin <= 12; pin++) pinMode(pin, OUTPUT);
  put(0x0D, 0x0B, 1); put(0x0D, 0x09, 0x0D);
  put(0x1E, 0, 0x18); put(0x1E, 2, 0);
  delay(50);
  tell();
  digitalWrite(8, HIGH); digitalWrite(12, HIGH); analogWrite(5, 110); analogWrite(6, 110);
  delay(700);
  digitalWrite(8, LOW); digitalWrite(12, LOW);
  delay(400);
  tell();
}
void loop() {}
