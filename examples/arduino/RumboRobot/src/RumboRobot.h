// Motors, encoders, sonars and servo of a small differential-drive robot: two gear motors behind an L298N, a Hall sensor
// on each motor, HC-SR04 sonars, a servo. Nothing here waits: call update() in each loop().
#pragma once

#include <Arduino.h>
#include <Servo.h>

// A pin of RumboPins with nothing on it.
const uint8_t NOT_WIRED = 255;

// Which pin each part is on. Enables need PWM, encoders an external interrupt, echoes an external or a pin change one.
struct RumboPins {
  struct Motor { uint8_t enable, forward, backward, encoder; } left, right;
  struct Echo { uint8_t trigger, echo; } sonars[3];  // front, left, right
  uint8_t servo;
};

// The robot of the report on its Mega, final build.
constexpr RumboPins RUMBO_MEGA = {{6, 7, 8, 21}, {5, 4, 2, 20}, {{14, 3}, {15, 19}, {12, 18}}, 9};
// The same on an Uno: two encoders, one sonar, the servo. The servo takes the PWM from pins 9 and 10.
constexpr RumboPins RUMBO_UNO = {
    {6, 7, 8, 3}, {5, 4, 10, 2}, {{12, 13}, {NOT_WIRED, NOT_WIRED}, {NOT_WIRED, NOT_WIRED}}, 9};
// That of the board for which the sketch is compiled.
#ifdef ARDUINO_AVR_MEGA2560
constexpr RumboPins RUMBO_BOARD = RUMBO_MEGA;
#else
constexpr RumboPins RUMBO_BOARD = RUMBO_UNO;
#endif

class RumboRobot {
 public:
  enum Sonar { FRONT, LEFT, RIGHT };

  explicit RumboRobot(const RumboPins &pins = RUMBO_BOARD) : pins(pins) {}

  // Once, in setup(). One robot at a time has the interrupts.
  void begin();
  // In each loop(): triggers the sonars by turns, one every 60 ms.
  void update();

  // PWM of the wheels, -255 (backward) to 255; 0 lets them roll.
  void drive(int left, int right);
  void stop() { drive(0, 0); }

  // Edges of the encoders since begin(), backward ones negative: a single Hall sensor does not tell the direction, so the
  // one in which the wheel is driven, or was last, counts.
  long leftCount() { return count(0); }
  long rightCount() { return count(1); }
  // Edges per second between the last two calls of this function for the wheel.
  float leftSpeed() { return speed(0); }
  float rightSpeed() { return speed(1); }

  // The last range [cm], 0 without an echo, and how old it is [ms].
  float distance(Sonar sonar = FRONT);
  unsigned long age(Sonar sonar = FRONT);

  // Where the servo points [degrees]: 0 to the right, 90 ahead, 180 to the left.
  void look(int degrees);

  // A value for the Arduino IDE's Serial Plotter: `name:value`, and plotEnd() after the last one of a row.
  void plot(const char *name, float value);
  void plotEnd();

 private:
  struct Wheel {
    volatile long count;
    volatile int8_t direction;
    long lastCount;
    unsigned long last_us;
  };
  struct Range {
    volatile unsigned long rise_us, width_us, end_ms;
    volatile bool waits, high;
  };

  const RumboPins pins;
  Wheel wheels[2] = {};
  Range ranges[3] = {};
  Servo servo;
  uint8_t turn = 0;
  unsigned long triggered_ms = 0;
  bool plotting = false;

  void put(const RumboPins::Motor &motor, Wheel &wheel, int pwm);
  long count(uint8_t wheel);
  float speed(uint8_t wheel);
  void listen(uint8_t pin, void (*handler)());
  void edge(uint8_t wheel) { wheels[wheel].count += wheels[wheel].direction; }
  void echo(uint8_t sonar);

  static RumboRobot *instance;
  static void leftEdge() { instance->edge(0); }
  static void rightEdge() { instance->edge(1); }
  static void frontEcho() { instance->echo(FRONT); }
  static void leftEcho() { instance->echo(LEFT); }
  static void rightEcho() { instance->echo(RIGHT); }

 public:
  // For the pin change interrupts.
  static void pinChange();
};
