#include "endless.h"

void endless_initialize(struct endless *self)
{
    self->y = 0.0;
}

void endless_reset(struct endless *self)
{
    self->y = 0.0;
}

void endless_calculate(struct endless *self)
{
    volatile int goes_on = 1;
    while (goes_on != 0) {
        self->y = self->x;
    }
}
