int low[2] = {1023, 1023}, high[2] = {0, 0};
int share(byte i) { return constrain(map(analogRead(A0 + 2 * i), low[i], high[i], 0, 100), 0, 100); }
void setup() {
  DDRD |= 0xE8; DDRB |= 1;
  while (millis() < 2500)
    for (byte i = 0; i < 2; i++) {
      int now = analogRead(A0 + 2 * i);
      low[i] = min(low[i], now); high[i] = max(high[i], now);
    }
  while (high[0] - low[0] < 400 || high[1] - low[1] < 400) ;
  digitalWrite(3, HIGH); digitalWrite(7, HIGH); digitalWrite(8, HIGH);
}
void loop() {
  int turn = share(1) - share(0);
  analogWrite(6, constrain(85 - turn, 0, 160)); analogWrite(5, constrain(85 + turn, 0, 160));
}
