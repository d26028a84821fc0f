// Two tasks on stacks of their own, switched by a timer's interrupt as a scheduler does it.

volatile unsigned long counts[2];
volatile unsigned int switches = 0;
byte stacks[2][200];
byte *tops[2];
byte current = 0;
volatile bool intact = true;

#define SAVE() asm volatile( \
  "push r0\n in r0, __SREG__\n cli\n push r0\n in r0, 0x3B\n push r0\n in r0, 0x3C\n push r0\n push r1\n clr r1\n" \
  "push r2\n push r3\n push r4\n push r5\n push r6\n push r7\n push r8\n push r9\n push r10\n push r11\n" \
  "push r12\n push r13\n push r14\n push r15\n push r16\n push r17\n push r18\n push r19\n push r20\n push r21\n" \
  "push r22\n push r23\n push r24\n push r25\n push r26\n push r27\n push r28\n push r29\n push r30\n push r31\n")
#define RESTORE() asm volatile( \
  "pop r31\n pop r30\n pop r29\n pop r28\n pop r27\n pop r26\n pop r25\n pop r24\n pop r23\n pop r22\n" \
  "pop r21\n pop r20\n pop r19\n pop r18\n pop r17\n pop r16\n pop r15\n pop r14\n pop r13\n pop r12\n" \
  "pop r11\n pop r10\n pop r9\n pop r8\n pop r7\n pop r6\n pop r5\n pop r4\n pop r3\n pop r2\n pop r1\n" \
  "pop r0\n out 0x3C, r0\n pop r0\n out 0x3B, r0\n pop r0\n out __SREG__, r0\n pop r0\n")

ISR(TIMER5_COMPA_vect, ISR_NAKED) {
  SAVE();
  // Not a call: the stack pointer changes inside.
  tops[current] = (byte *)SP;
  current ^= 1;
  SP = (int)tops[current];
  switches++;
  RESTORE();
  asm volatile("reti");
}

void work(byte task) {
  float sum = 0;
  unsigned long local = 0;
  for (;;) {
    local++;
    sum += task + 0.5;
    if (local % 100 == 0 && fabs(sum - local * (task + 0.5)) > 0.01 * sum) intact = false;
    noInterrupts();
    counts[task]++;
    if (counts[task] != local) intact = false;
    interrupts();
  }
}

void first() { work(0); }
void second() { work(1); }

void prepare(byte task, void (*entry)()) {
  byte *top = &stacks[task][199];
  unsigned int address = (unsigned int)entry;
  *top-- = address & 0xFF;
  *top-- = address >> 8;
  *top-- = 0;
  *top-- = 0;     // r0
  *top-- = 0x80;  // SREG
  for (byte left = 2 + 31; left; left--) *top-- = 0;
  tops[task] = top;
}

void setup() {
  noInterrupts();
  prepare(0, first);
  prepare(1, second);
  TCCR5A = 0;
  TCCR5B = _BV(WGM52) | _BV(CS51) | _BV(CS50);
  OCR5A = 249;  // 1 ms
  TIMSK5 = _BV(OCIE5A);
  SP = (int)tops[0];
  RESTORE();
  asm volatile("ret");
}

void loop() {
}
