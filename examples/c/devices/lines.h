/* SPDX-License-Identifier: 0BSD
 *
 * Two lines of a GPIO chip, with the character device of Linux 5.10 and newer.
 */
#ifndef LINES_H
#define LINES_H

#include <stdbool.h>
#include <stdint.h>

struct lines {
    bool button; /* the ports */
    bool lamp;
    int input; /* the requested lines */
    int output;
};

bool lines_open(struct lines *self, const char *chip, int64_t buttonLine, int64_t lampLine);
void lines_close(struct lines *self);
bool lines_read_button(struct lines *self);
void lines_write_lamp(struct lines *self);

#endif
