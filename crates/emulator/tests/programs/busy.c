/* Computes once a millisecond and waits in a loop for the next one. */
#include "control.h"

#ifndef SECONDS
#define SECONDS 10
#endif

int main(void)
{
    uint8_t done = 0;
    set_up();
    for (uint16_t count = 0; count < 1000 * SECONDS; count++) {
        while (ticks == done)
            ;
        done++;
        tick();
    }
    end();
}
