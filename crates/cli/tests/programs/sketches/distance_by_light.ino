// Two VL53L0X that XSHUT tells apart are set up as their libraries do; prints the mean of what each measures.
byte keep[2];
void hold(byte at, byte value) {
  put(at, 0x80, 1); put(at, 0xFF, 1); put(at, 0x00, 0);
  if (value) put(at, 0x91, value); else keep[at & 1] = get(at, 0x91);
  put(at, 0x00, 1); put(at, 0xFF, 0); put(at, 0x80, 0);
}
void ready(byte at) { while (!(get(at, 0x13) & 7)) {} put(at, 0x0B, 1); }
void setup_sensor(byte at) {
  hold(at, 0);
  put(at, 0xFF, 7); put(at, 0x94, 0x6B); put(at, 0x83, 0);
  while (!get(at, 0x83)) {}
  Serial.println(get(at, 0x92) & 0x7F);
  put(at, 0xFF, 0); put(at, 0x52, 0x96); put(at, 0x0A, 4);
  put(at, 0x01, 1); put(at, 0x00, 0x41); ready(at); put(at, 0x00, 0);
  put(at, 0x01, 2); put(at, 0x00, 1); ready(at); put(at, 0x00, 0);
  put(at, 0x01, 0xE8);
  hold(at, keep[at & 1]);
  put(at, 0x00, 2);
}
int mean(byte at) {
  long sum = 0;
  for (byte n = 0; n < 30; n++) {
    while (!(get(at, 0x13) & 7)) {}
    sum += get(at, 0x1E) << 8 | get(at, 0x1F);
    put(at, 0x0B, 1);
  }
  return sum / 30;
}
void setup() {
  Serial.begin(115200);
  TWBR = 12;
  pinMode(2, OUTPUT); pinMode(3, OUTPUT);
  delay(5);
  Serial.println(there(0x29));
  pinMode(2, INPUT); delay(2);
  put(0x29, 0x8A, 0x30);
  Serial.println(there(0x29));
  pinMode(3, INPUT); delay(2);
  Serial.println(there(0x29) && there(0x30));
  setup_sensor(0x29); setup_sensor(0x30);
  Serial.println(mean(0x29)); Serial.println(mean(0x30));
}
void loop() {}
