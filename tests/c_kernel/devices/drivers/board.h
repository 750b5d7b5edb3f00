#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stdint.h>

#include "tank_types.h"

struct board {
    double level; /* the ports, */
    bool pressed;
    double drive;
    bool lamps[2];
    int64_t channel; /* and what else it needs */
    double scale;
    int samples;
};

bool board_open(struct board *self, int64_t channel, double scale, const char *name, enum tank_mode mode);
void board_close(struct board *self);
bool board_read_level(struct board *self);
bool board_read_pressed(struct board *self);
void board_write_drive(struct board *self);
void board_write_lamps(struct board *self, uint32_t index);

#endif
