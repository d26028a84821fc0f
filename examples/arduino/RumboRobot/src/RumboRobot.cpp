#include "RumboRobot.h"

// Sonars are triggered this far apart, so that none takes another's echo for its own [ms].
static const unsigned long TURN_MS = 60;
// An echo of 2.5 m; the line of a lost one stays high for longer [us].
static const unsigned long LONGEST_US = 14600;
static const float US_PER_CM = 58.0;

RumboRobot *RumboRobot::instance = nullptr;

void RumboRobot::begin() {
  instance = this;
  const RumboPins::Motor *motors[] = {&pins.left, &pins.right};
  void (*edges[])() = {leftEdge, rightEdge};
  void (*echoes[])() = {frontEcho, leftEcho, rightEcho};
  for (uint8_t i = 0; i < 2; i++) {
    const uint8_t outputs[] = {motors[i]->enable, motors[i]->forward, motors[i]->backward};
    for (uint8_t pin : outputs) {
      digitalWrite(pin, LOW);
      pinMode(pin, OUTPUT);
    }
    wheels[i].direction = 1;
    wheels[i].last_us = micros();
    if (motors[i]->encoder != NOT_WIRED) {
      pinMode(motors[i]->encoder, INPUT_PULLUP);
      listen(motors[i]->encoder, edges[i]);
    }
  }
  for (uint8_t i = 0; i < 3; i++) {
    if (pins.sonars[i].trigger == NOT_WIRED) continue;
    digitalWrite(pins.sonars[i].trigger, LOW);
    pinMode(pins.sonars[i].trigger, OUTPUT);
    pinMode(pins.sonars[i].echo, INPUT);
    listen(pins.sonars[i].echo, echoes[i]);
  }
}

// By the pin's external interrupt, else by its pin change interrupt.
void RumboRobot::listen(uint8_t pin, void (*handler)()) {
  int number = digitalPinToInterrupt(pin);
  if (number != NOT_AN_INTERRUPT) {
    attachInterrupt(number, handler, CHANGE);
  } else if (digitalPinToPCICR(pin)) {
    *digitalPinToPCMSK(pin) |= bit(digitalPinToPCMSKbit(pin));
    *digitalPinToPCICR(pin) |= bit(digitalPinToPCICRbit(pin));
  }
}

void RumboRobot::drive(int left, int right) {
  put(pins.left, wheels[0], left);
  put(pins.right, wheels[1], right);
}

void RumboRobot::put(const RumboPins::Motor &motor, Wheel &wheel, int pwm) {
  digitalWrite(motor.forward, pwm > 0);
  digitalWrite(motor.backward, pwm < 0);
  analogWrite(motor.enable, min(abs(pwm), 255));
  if (pwm != 0) wheel.direction = pwm > 0 ? 1 : -1;
}

long RumboRobot::count(uint8_t wheel) {
  noInterrupts();
  long count = wheels[wheel].count;
  interrupts();
  return count;
}

float RumboRobot::speed(uint8_t index) {
  Wheel &wheel = wheels[index];
  long now = count(index);
  unsigned long now_us = micros();
  float speed = now_us == wheel.last_us ? 0 : (now - wheel.lastCount) * 1e6 / (now_us - wheel.last_us);
  wheel.lastCount = now;
  wheel.last_us = now_us;
  return speed;
}

void RumboRobot::update() {
  unsigned long now_ms = millis();
  if (now_ms - triggered_ms < TURN_MS) return;
  for (uint8_t tried = 0; tried < 3; tried++) {
    turn = (turn + 1) % 3;
    uint8_t trigger = pins.sonars[turn].trigger;
    // A line that is still high has lost its echo.
    if (trigger == NOT_WIRED || digitalRead(pins.sonars[turn].echo)) continue;
    Range &range = ranges[turn];
    if (range.waits) {  // no echo at all since the last trigger
      range.width_us = 0;
      range.end_ms = now_ms;
    }
    range.waits = true;
    triggered_ms = now_ms;
    digitalWrite(trigger, HIGH);
    delayMicroseconds(10);
    digitalWrite(trigger, LOW);
    return;
  }
}

void RumboRobot::echo(uint8_t sonar) {
  Range &range = ranges[sonar];
  bool high = digitalRead(pins.sonars[sonar].echo);
  if (high == range.high) return;
  range.high = high;
  if (high) {
    range.rise_us = micros();
  } else if (range.waits) {
    unsigned long width_us = micros() - range.rise_us;
    range.width_us = width_us > LONGEST_US ? 0 : width_us;
    range.end_ms = millis();
    range.waits = false;
  }
}

float RumboRobot::distance(Sonar sonar) {
  noInterrupts();
  unsigned long width_us = ranges[sonar].width_us;
  interrupts();
  return width_us / US_PER_CM;
}

unsigned long RumboRobot::age(Sonar sonar) {
  noInterrupts();
  unsigned long end_ms = ranges[sonar].end_ms;
  interrupts();
  return millis() - end_ms;
}

void RumboRobot::look(int degrees) {
  if (!servo.attached()) servo.attach(pins.servo);
  servo.write(degrees);
}

void RumboRobot::plot(const char *name, float value) {
  if (plotting) Serial.print(',');
  plotting = true;
  Serial.print(name);
  Serial.print(':');
  Serial.print(value);
}

void RumboRobot::plotEnd() {
  plotting = false;
  Serial.println();
}

// Which line has changed is seen from the lines themselves.
void RumboRobot::pinChange() {
  if (!instance) return;
  for (uint8_t sonar = FRONT; sonar <= RIGHT; sonar++) {
    uint8_t pin = instance->pins.sonars[sonar].echo;
    if (pin != NOT_WIRED && digitalPinToInterrupt(pin) == NOT_AN_INTERRUPT) instance->echo(sonar);
  }
}

ISR(PCINT0_vect) { RumboRobot::pinChange(); }
ISR(PCINT1_vect) { RumboRobot::pinChange(); }
ISR(PCINT2_vect) { RumboRobot::pinChange(); }
