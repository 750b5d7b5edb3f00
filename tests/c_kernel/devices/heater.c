#include "heater.h"

void heater_initialize(struct heater *self)
{
    heater_reset(self);
}

void heater_reset(struct heater *self)
{
    self->calls = 0;
}

void heater_calculate(struct heater *self)
{
    self->calls++;
    self->power = 2.0 * self->level;
    if (self->calls == 5) {
        heater_fails(self);
    }
}
