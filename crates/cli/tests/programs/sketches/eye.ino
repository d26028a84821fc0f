// A VL53L0X on the servo looks ahead, to the left and to the right.
int range() {
  put(0x29, 0x00, 1);
  while (!(get(0x29, 0x13) & 7)) {}
  put(0x29, 0x0B, 1);
  return get(0x29, 0x1E) << 8 | get(0x29, 0x1F);
}
void look(int us) {
  for (byte n = 0; n < 30; n++) { digitalWrite(10, HIGH); delayMicroseconds(us); digitalWrite(10, LOW); delay(17); }
}
void setup() {
  Serial.begin(115200);
  pinMode(10, OUTPUT);
  put(0x29, 0x0A, 4); put(0x29, 0x01, 0xE8);
  look(1500); Serial.println(range());
  look(2400); Serial.println(range());
  look(600); Serial.println(range());
}
void loop() {}
