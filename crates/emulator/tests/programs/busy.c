/* Computes at every tick and waits in a loop for the next one. */
#include "control.h"

#ifndef SECONDS
#define SECONDS 10
#endif

int main(void)
{
    uint8_t done = 0;
    set_up();
    for (uint16_t count = 0; count < (uint16_t)(HERTZ * SECONDS); count++) {
        while (ticks == done)
            ;
        done++;
        tick();
    }
    end();
}
