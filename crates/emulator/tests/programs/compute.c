/* Computes without a pause and uses nothing but the CPU, so that it runs on any AVR, and on emulators without timers. */
#include <avr/io.h>
#undef PORTB
#undef OCR3A
#undef OCR4A
#define PORTB GPIOR1
#define OCR3A GPIOR2
#define OCR4A GPIOR2
#include "control.h"

int main(void)
{
    for (uint16_t count = 0; count < 50000; count++)
        tick();
    /* For what does not see the end. */
    GPIOR0 = 0xA5;
    end();
}
