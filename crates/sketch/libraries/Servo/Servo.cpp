#include "Servo.h"

// Timer 5 of a Mega, else timer 1, as Arduino's library has them.
#ifdef TCNT5
#define OF_TIMER(before, after) before##5##after
#else
#define OF_TIMER(before, after) before##1##after
#endif

namespace {

const uint8_t SERVOS = 12;
const uint8_t NONE = 255;
const uint16_t TICKS_PER_MICROSECOND = 2;  // 16 MHz / 8
const uint16_t ROUND = 20000U * TICKS_PER_MICROSECOND;
const uint16_t LATE = 4;  // a compare value nearer than this could be missed

struct Channel {
  uint8_t pin;
  bool active;
  volatile uint16_t ticks;
};

Channel channels[SERVOS];
volatile uint8_t used = 0;
// The channel whose pulse runs; SERVOS between rounds.
volatile uint8_t current = SERVOS;

}  // namespace

ISR(OF_TIMER(TIMER, _COMPA_vect)) {
  if (current == SERVOS) {
    OF_TIMER(TCNT, ) = 0;
    current = 0;
  } else {
    if (channels[current].active) {
      digitalWrite(channels[current].pin, LOW);
    }
    current++;
  }
  if (current < used) {
    OF_TIMER(OCR, A) = OF_TIMER(TCNT, ) + channels[current].ticks;
    if (channels[current].active) {
      digitalWrite(channels[current].pin, HIGH);
    }
  } else {
    const uint16_t now = OF_TIMER(TCNT, );
    OF_TIMER(OCR, A) = now + LATE < ROUND ? ROUND : now + LATE;
    current = SERVOS;
  }
}

Servo::Servo() : index(used < SERVOS ? used : NONE), least(544), most(2400) {
  if (index != NONE) {
    channels[index].ticks = 1500 * TICKS_PER_MICROSECOND;
    used = used + 1;
  }
}

uint8_t Servo::attach(int pin, int least_us, int most_us) {
  if (index == NONE) {
    return NONE;
  }
  least = least_us;
  most = most_us;
  pinMode(pin, OUTPUT);
  channels[index].pin = pin;
  if (!(OF_TIMER(TIMSK, ) & _BV(OF_TIMER(OCIE, A)))) {
    OF_TIMER(TCCR, A) = 0;
    OF_TIMER(TCCR, B) = _BV(OF_TIMER(CS, 1));
    OF_TIMER(TCNT, ) = 0;
    OF_TIMER(TIFR, ) = _BV(OF_TIMER(OCF, A));
    OF_TIMER(TIMSK, ) = _BV(OF_TIMER(OCIE, A));
  }
  channels[index].active = true;
  return index;
}

void Servo::detach() {
  if (index != NONE) {
    channels[index].active = false;
  }
}

bool Servo::attached() const {
  return index != NONE && channels[index].active;
}

void Servo::write(int value) {
  writeMicroseconds(value < 544 ? map(constrain(value, 0, 180), 0, 180, least, most) : value);
}

void Servo::writeMicroseconds(int microseconds) {
  if (index == NONE) {
    return;
  }
  // Between the match and the pin lie some 2 us.
  const uint16_t ticks = (constrain(microseconds, least, most) - 2) * TICKS_PER_MICROSECOND;
  const uint8_t before = SREG;
  cli();
  channels[index].ticks = ticks;
  SREG = before;
}

int Servo::read() const {
  return map(readMicroseconds() + 1, least, most, 0, 180);
}

int Servo::readMicroseconds() const {
  return index == NONE ? 0 : channels[index].ticks / TICKS_PER_MICROSECOND + 2;
}
