// Shifts eight bits into the register of a motor shield.
void put(byte bits) {
  digitalWrite(12, LOW);
  for (int bit = 7; bit >= 0; bit--) {
    digitalWrite(4, LOW); digitalWrite(8, bits >> bit & 1); digitalWrite(4, HIGH);
  }
  digitalWrite(12, HIGH);
  digitalWrite(7, LOW);
}
