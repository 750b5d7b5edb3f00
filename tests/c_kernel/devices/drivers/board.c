#include "board.h"

#include <stdio.h>
#include <stdlib.h>

bool board_open(struct board *self, int64_t channel, double scale, const char *name, enum tank_mode mode)
{
    self->channel = channel;
    self->scale = scale;
    self->samples = 0;
    (void)fprintf(stderr, "open %d %g %s %d\n", (int)channel, scale, name, (int)mode);
    return getenv("NO_BOARD") == NULL;
}

void board_close(struct board *self)
{
    (void)fprintf(stderr, "close %d after %d samples\n", (int)self->channel, self->samples);
}

bool board_read_level(struct board *self)
{
    self->samples++;
    self->level = self->scale * self->samples;
    return true;
}

bool board_read_pressed(struct board *self)
{
    self->pressed = self->samples >= 10;
    return self->pressed;
}

void board_write_drive(struct board *self)
{
    (void)fprintf(stderr, "drive %g\n", self->drive);
}

void board_write_lamps(struct board *self, uint32_t index)
{
    (void)fprintf(stderr, "lamp %u %d\n", (unsigned)index, self->lamps[index]);
}
