#ifndef ENDLESS_H
#define ENDLESS_H

struct endless {
    double x;
    double y;
};

void endless_initialize(struct endless *self);
void endless_reset(struct endless *self);
void endless_calculate(struct endless *self);

#endif
