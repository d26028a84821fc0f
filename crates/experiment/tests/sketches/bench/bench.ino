// A robot on a string: does what a line on the Bluetooth link says, and answers with a line.
// Final wiring: ENA 5, ENB 6, IN1 2, IN2 4, IN3 8, IN4 7, servo 9, front sonar 14 / 3, encoders 21 and 20, link on Serial2.

#include <Servo.h>

const byte ENABLES[] = {6, 5};
const byte FORWARDS[] = {7, 4};
const byte BACKWARDS[] = {8, 2};
const byte SERVO = 9;
const byte TRIGGER = 14;
const byte ECHO = 3;

volatile unsigned long leftCount = 0;
volatile unsigned long rightCount = 0;
Servo servo;
// Share of time that a hand-made PWM of 1 kHz is high, in percent; 0 is off.
byte softPercent = 0;

void countLeft() { leftCount++; }
void countRight() { rightCount++; }

void setup() {
  for (byte side = 0; side < 2; side++) {
    pinMode(ENABLES[side], OUTPUT);
    pinMode(FORWARDS[side], OUTPUT);
    pinMode(BACKWARDS[side], OUTPUT);
  }
  pinMode(TRIGGER, OUTPUT);
  pinMode(ECHO, INPUT);
  attachInterrupt(digitalPinToInterrupt(21), countLeft, CHANGE);
  attachInterrupt(digitalPinToInterrupt(20), countRight, CHANGE);
  Serial.begin(115200);
  Serial2.begin(9600);
  Serial.println("bench is ready");
}

void direction(bool forward, bool backward) {
  for (byte side = 0; side < 2; side++) {
    digitalWrite(FORWARDS[side], forward);
    digitalWrite(BACKWARDS[side], backward);
  }
}

void enable(int pwm) {
  for (byte side = 0; side < 2; side++) analogWrite(ENABLES[side], pwm);
}

void ping() {
  digitalWrite(TRIGGER, LOW);
  delayMicroseconds(4);
  digitalWrite(TRIGGER, HIGH);
  delayMicroseconds(10);
  digitalWrite(TRIGGER, LOW);
  Serial2.print("ECHO ");
  Serial2.println(pulseIn(ECHO, HIGH, 60000));
}

void obey(const String& line) {
  int value = line.substring(line.indexOf(' ') + 1).toInt();
  softPercent = 0;
  if (line.startsWith("DUTY")) {
    direction(value > 0, value < 0);
    enable(abs(value));
  } else if (line.startsWith("FULL")) {
    direction(HIGH, LOW);
    for (byte side = 0; side < 2; side++) digitalWrite(ENABLES[side], HIGH);
  } else if (line.startsWith("SOFT")) {
    direction(HIGH, LOW);
    softPercent = value;
  } else if (line.startsWith("FAST")) {
    // Timers 3 and 4 without prescaler: 31.4 kHz.
    TCCR3B = (TCCR3B & 0xF8) | 1;
    TCCR4B = (TCCR4B & 0xF8) | 1;
    direction(HIGH, LOW);
    enable(value);
  } else if (line.startsWith("COAST")) {
    enable(0);
  } else if (line.startsWith("BRAKE")) {
    direction(HIGH, HIGH);
    for (byte side = 0; side < 2; side++) digitalWrite(ENABLES[side], HIGH);
  } else if (line.startsWith("SERVO")) {
    servo.attach(SERVO);
    servo.write(value);
  } else if (line.startsWith("LIMP")) {
    servo.detach();
  } else if (line.startsWith("PING")) {
    ping();
  } else if (line.startsWith("COUNT")) {
    noInterrupts();
    unsigned long left = leftCount, right = rightCount;
    interrupts();
    Serial2.print("COUNT ");
    Serial2.print(left);
    Serial2.print(' ');
    Serial2.println(right);
  } else if (line.startsWith("BAUD")) {
    Serial2.begin(value * 100L);
    Serial2.println("at another rate");
  } else if (line.startsWith("CRASH")) {
    // A pointer counts words: the middle of the flash, where nothing is.
    void (*nowhere)() = (void (*)())0x8000;
    nowhere();
  }
}

String line;

void loop() {
  while (Serial2.available()) {
    char c = Serial2.read();
    if (c == '\n') {
      obey(line);
      line = "";
    } else {
      line += c;
    }
  }
  if (softPercent > 0) {
    for (byte side = 0; side < 2; side++) digitalWrite(ENABLES[side], HIGH);
    delayMicroseconds(10 * softPercent);
    for (byte side = 0; side < 2; side++) digitalWrite(ENABLES[side], LOW);
    delayMicroseconds(1000 - 10 * softPercent);
  }
}
