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
    volatile int continues = 1;
    while (continues != 0) {
        self->y = self->x;
    }
}
