/* What compiled programs do: each part computes something, and then reports all registers, SREG, the stack pointer, the cycles
 * that it took and a hash of the memory, in hexadecimal, as a line on USART0. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/sleep.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define STORE(n) "sts seen+" #n ", r" #n "\n\t"

/* r0 to r31, SREG, SPL, SPH, TCNT1L, TCNT1H. */
uint8_t seen[37] __attribute__((used));

__attribute__((noinline, naked)) static void look(void)
{
    __asm__ volatile(
        STORE(0) STORE(1) STORE(2) STORE(3) STORE(4) STORE(5) STORE(6) STORE(7)
        STORE(8) STORE(9) STORE(10) STORE(11) STORE(12) STORE(13) STORE(14) STORE(15)
        STORE(16) STORE(17) STORE(18) STORE(19) STORE(20) STORE(21) STORE(22) STORE(23)
        STORE(24) STORE(25) STORE(26) STORE(27) STORE(28) STORE(29) STORE(30) STORE(31)
        "in r24, 0x3f\n\t" "sts seen+32, r24\n\t"
        "in r24, 0x3d\n\t" "sts seen+33, r24\n\t"
        "in r24, 0x3e\n\t" "sts seen+34, r24\n\t"
        "lds r24, 0x84\n\t" "sts seen+35, r24\n\t"
        "lds r24, 0x85\n\t" "sts seen+36, r24\n\t"
        "lds r24, seen+24\n\t" "ret\n\t");
}

static void send(char byte)
{
    while (!(UCSR0A & _BV(UDRE0)))
        ;
    UDR0 = byte;
}

static void send_hex(uint8_t byte)
{
    static const char digits[] PROGMEM = "0123456789ABCDEF";
    send(pgm_read_byte(&digits[byte >> 4]));
    send(pgm_read_byte(&digits[byte & 15]));
}

static void report(void)
{
    uint16_t hash = 0;
    for (const uint8_t *byte = (const uint8_t *)RAMSTART; byte < (const uint8_t *)(RAMEND - 0xFF); byte++)
        hash = (hash << 1 | hash >> 15) ^ *byte;
    for (uint8_t i = 0; i < sizeof seen; i++)
        send_hex(seen[i]);
    send_hex(hash);
    send_hex(hash >> 8);
    send('\n');
}

static volatile float angle = 0.7f;
static volatile int32_t number = -123456789;
static volatile uint64_t wide = 0x123456789ABCDEFULL;
static float results[8];
static int16_t sorted[40];
static char text[64];

static void floats(void)
{
    for (uint8_t i = 0; i < 8; i++)
        results[i] = sinf(angle * i) * atan2f(angle, i - 3.5f) + sqrtf(i) / (angle + i) - fmodf(i * 7.1f, angle);
}

static void integers(void)
{
    number = number / 37 * 1001 % 65537 + (number >> 5);
    wide = wide * 6364136223846793005ULL / 1442695040888963407ULL + (wide >> 13);
    number ^= (int32_t)(int16_t)number * (int16_t)(number >> 16);
}

static int ascending(const void *a, const void *b)
{
    return *(const int16_t *)a - *(const int16_t *)b;
}

static void sorting(void)
{
    uint16_t state = 0xACE1;
    for (uint8_t i = 0; i < 40; i++) {
        state = state >> 1 ^ (-(state & 1) & 0xB400);
        sorted[i] = state;
    }
    qsort(sorted, 40, sizeof sorted[0], ascending);
}

static void strings(void)
{
    ltoa(number, text, 10);
    strcat_P(text, PSTR(" and "));
    dtostrf(angle * 1000.0f, 9, 3, text + strlen(text));
    strrev(text);
    memmove(text + 3, text, 20);
}

static uint32_t ackermann(uint16_t m, uint16_t n)
{
    return m == 0 ? n + 1u : n == 0 ? ackermann(m - 1, 1) : ackermann(m - 1, ackermann(m, n - 1));
}

static void recursion(void) { number = ackermann(2, 9); }

static uint8_t by_switch(uint8_t x)
{
    switch (x) {
    case 0: return 17;
    case 1: return 3;
    case 2: return 99;
    case 3: return x << 3;
    case 4: return 250;
    case 5: return x ^ 0x55;
    case 6: return 1;
    case 7: return 42;
    default: return x;
    }
}

static void jumps(void)
{
    static void (*const parts[])(void) = {integers, sorting};
    uint8_t sum = 0;
    for (uint8_t i = 0; i < 10; i++)
        sum += by_switch(i);
    parts[sum & 1]();
    text[0] = sum;
}

static void (*const parts[])(void) = {floats, integers, sorting, strings, recursion, jumps};

int main(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = 0;
    UCSR0B = _BV(TXEN0);
    TCCR1B = _BV(CS10);
    for (uint8_t round = 0; round < 3; round++) {
        for (uint8_t part = 0; part < sizeof parts / sizeof parts[0]; part++) {
            TCNT1 = 0;
            parts[part]();
            look();
            report();
        }
        angle = angle * 1.7f + 0.3f;
    }
    /* SLEEP with interrupts off: simavr ends here. */
    cli();
    sleep_enable();
    sleep_cpu();
    for (;;)
        ;
}
