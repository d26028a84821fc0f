/* What a student's control loop computes: two speed loops in floating point and odometry, HERTZ times a second. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <math.h>
#include <stdint.h>

#ifndef HERTZ
#define HERTZ 1000
#endif

static volatile uint8_t ticks;

ISR(TIMER1_COMPA_vect) { ticks++; }

struct wheel {
    float ref_rad_s, speed_rad_s, integral, last_error;
    uint16_t last_count;
};

static struct wheel left = {.ref_rad_s = 12.0f}, right = {.ref_rad_s = 11.0f};
static float x_m, y_m, heading_rad;

static uint8_t step(struct wheel *wheel, uint16_t count)
{
    const float period_s = 1.0f / HERTZ, rad_per_edge = 0.00327f;
    int16_t edges = count - wheel->last_count;
    wheel->last_count = count;
    wheel->speed_rad_s += 0.1f * (edges * rad_per_edge / period_s - wheel->speed_rad_s);
    float error = wheel->ref_rad_s - wheel->speed_rad_s;
    float duty = 6.0f * error + wheel->integral + 0.02f * (error - wheel->last_error) / period_s;
    wheel->last_error = error;
    if (duty > 0.0f && duty < 255.0f)
        wheel->integral += 40.0f * error * period_s;
    return duty < 0.0f ? 0 : duty > 255.0f ? 255 : (uint8_t)duty;
}

static void tick(void)
{
    const float radius_m = 0.033f, base_m = 0.15f, period_s = 1.0f / HERTZ;
    static uint16_t counts[2];
    counts[0] += 3;
    counts[1] += 3 - (counts[0] & 1);
    OCR3A = step(&left, counts[0]);
    OCR4A = step(&right, counts[1]);
    float forward_m = 0.5f * radius_m * period_s * (left.speed_rad_s + right.speed_rad_s);
    heading_rad += radius_m * period_s * (right.speed_rad_s - left.speed_rad_s) / base_m;
    x_m += forward_m * cosf(heading_rad);
    y_m += forward_m * sinf(heading_rad);
    PORTB ^= 0x80;
}

#ifdef TCCR3A
static void set_up(void)
{
    DDRB = 0x80;
    DDRE = 0x08;
    DDRH = 0x08;
    /* 490 Hz, phase-correct. */
    TCCR3A = TCCR4A = 0x81;
    TCCR3B = TCCR4B = 0x03;
    /* 16 MHz / 8. */
    OCR1A = 2000000UL / HERTZ - 1;
    TIMSK1 = 0x02;
    TCCR1B = 0x0A;
    set_sleep_mode(SLEEP_MODE_IDLE);
    sei();
}
#endif

/* SLEEP with interrupts off: a simulation ends here. */
static void end(void)
{
    cli();
    sleep_enable();
    sleep_cpu();
    for (;;)
        ;
}
