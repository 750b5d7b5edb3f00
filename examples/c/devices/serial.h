/* SPDX-License-Identifier: 0BSD
 *
 * A board behind a serial line of POSIX: lines of text, NAME VALUE.
 */
#ifndef SERIAL_H
#define SERIAL_H

#include <stdbool.h>
#include <stdint.h>
#include <termios.h>

struct serial {
    double level; /* the ports */
    double valve;
    int file;
    struct termios before;
    char line[64]; /* what has come of the present line */
    unsigned length;
    bool is_complete; /* whether its beginning has come */
};

bool serial_open(struct serial *self, const char *path, int64_t baud);
void serial_close(struct serial *self);
bool serial_read_level(struct serial *self);
void serial_write_valve(struct serial *self);

#endif
