#ifndef HEATER_H
#define HEATER_H

struct heater {
    double level;
    double power;
    int calls;
};

void heater_initialize(struct heater *self);
void heater_reset(struct heater *self);
void heater_calculate(struct heater *self);
/* To be defined by the test: what goes wrong in the fifth call. */
void heater_fails(struct heater *self);

#endif
