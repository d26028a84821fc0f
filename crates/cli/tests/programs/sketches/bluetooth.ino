#include <SoftwareSerial.h>
SoftwareSerial phone(2, 3);
void setup() { phone.begin(38400); pinMode(5, OUTPUT); pinMode(7, OUTPUT); digitalWrite(7, HIGH); }
void loop() { if (phone.available() && phone.read() == 'F') { analogWrite(5, 150); phone.println("Forward"); } }
