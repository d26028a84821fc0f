volatile int count;
void ready() { count++; }
void set(byte reg, byte value) { start(0xD0); send(reg); send(value); stop(); }
void setup() {
  Serial.begin(115200);
  attachInterrupt(digitalPinToInterrupt(2), ready, RISING);
  set(0x6B, 1); set(0x1A, 3); set(0x19, 9); set(0x38, 1);
  delay(1000);
  Serial.println(count);
}
void loop() {}
