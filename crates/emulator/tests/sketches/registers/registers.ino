// A program without the core's functions: a USART by interrupts and its register settings, PCINT encoders, a state machine in a timer.

#include <util/atomic.h>

volatile byte head = 0, tail = 0;
volatile byte ring[32];
volatile long position = 0;
volatile unsigned int errors = 0, parity = 0;
volatile byte state = 0;
volatile unsigned long free_running = 0, conversions = 0;

ISR(USART3_RX_vect) {
  byte status = UCSR3A;
  byte data = UDR3;
  if (status & _BV(UPE3)) parity++;
  ring[head] = data;
  head = (head + 1) & 31;
}

ISR(USART3_UDRE_vect) {
  if (head == tail) {
    UCSR3B &= ~_BV(UDRIE3);
  } else {
    UDR3 = ring[tail];
    tail = (tail + 1) & 31;
  }
}

// A quadrature encoder on A8 and A9.
ISR(PCINT2_vect) {
  static byte before = 3;
  static const signed char table[] = {0, 1, -1, 0, -1, 0, 0, 1, 1, 0, 0, -1, 0, -1, 1, 0};
  byte now = PINK & 3;
  signed char step = table[before << 2 | now];
  if (before != now && step == 0) errors++;
  position += step;
  before = now;
}

// Light after light, by a timer that sets its own next time.
ISR(TIMER4_COMPB_vect) {
  static const unsigned int wait[] = {2500, 5000, 7500};
  state = (state + 1) % 3;
  OCR4B += wait[state];
  PORTC = _BV(state);
}

ISR(ADC_vect) {
  free_running = ADC;
  conversions++;
}

int main() {
  cli();
  // 9600 7E2, without U2X.
  UBRR3 = 103;
  UCSR3C = _BV(UPM31) | _BV(USBS3) | _BV(UCSZ31);
  UCSR3B = _BV(RXCIE3) | _BV(RXEN3) | _BV(TXEN3);
  PORTK = 3;
  PCMSK2 = 3;
  PCICR = _BV(PCIE2);
  DDRC = 7;
  PORTC = 1;
  TCCR4B = _BV(CS41);  // over 8
  OCR4B = 5000;
  TIMSK4 = _BV(OCIE4B);
  // The converter runs freely, over 128, on ADC2 against 2.56 V.
  ADMUX = _BV(REFS1) | _BV(REFS0) | 2;
  ADCSRB = 0;
  ADCSRA = _BV(ADEN) | _BV(ADSC) | _BV(ADATE) | _BV(ADIE) | 7;
  sei();
  for (;;) {
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
      if (head != tail) UCSR3B |= _BV(UDRIE3);
    }
  }
}
