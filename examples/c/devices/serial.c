/* SPDX-License-Identifier: 0BSD */
#define _DEFAULT_SOURCE

#include "serial.h"

#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static speed_t speed(int64_t baud)
{
    static const struct {
        int64_t baud;
        speed_t speed;
    } speeds[] = {{9600, B9600},     {19200, B19200},   {38400, B38400},
                  {57600, B57600},   {115200, B115200}, {230400, B230400}};

    for (size_t at = 0; at < sizeof speeds / sizeof speeds[0]; at++) {
        if (speeds[at].baud == baud) {
            return speeds[at].speed;
        }
    }
    return B0;
}

/* Opens the line without echo and translation. Errors are printed with what to do. */
bool serial_open(struct serial *self, const char *path, int64_t baud)
{
    struct termios raw;

    self->length = 0;
    self->is_complete = false; /* the first line may be cut */
    self->file = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (self->file < 0) {
        perror(path); /* Permission denied: sudo usermod -aG dialout $USER */
        return false;
    }
    if (speed(baud) == B0 || tcgetattr(self->file, &self->before) != 0) {
        (void)fprintf(stderr, "%s: no serial line of %lld baud\n", path, (long long)baud);
        (void)close(self->file);
        return false;
    }
    raw = self->before;
    cfmakeraw(&raw);
    raw.c_cflag |= CLOCAL | CREAD;
    (void)cfsetspeed(&raw, speed(baud));
    if (tcsetattr(self->file, TCSANOW, &raw) != 0) {
        perror(path);
        (void)close(self->file);
        return false;
    }
    return true;
}

void serial_close(struct serial *self)
{
    (void)tcdrain(self->file);
    (void)tcsetattr(self->file, TCSANOW, &self->before);
    (void)close(self->file);
}

/* Takes a whole line: whether it has a level. */
static bool take(struct serial *self)
{
    static const char name[] = "level ";
    char *end = NULL;
    double value;

    if (strncmp(self->line, name, sizeof name - 1) != 0) {
        return false;
    }
    value = strtod(self->line + sizeof name - 1, &end);
    if (end == self->line + sizeof name - 1 || (*end != '\0' && *end != '\r')) {
        return false;
    }
    self->level = value;
    return true;
}

/* Whether a level has come since the last one; the latest is taken. */
bool serial_read_level(struct serial *self)
{
    bool is_new = false;
    char character;

    while (read(self->file, &character, 1) == 1) {
        if (character == '\n') {
            self->line[self->length] = '\0';
            is_new = (self->is_complete && take(self)) || is_new;
            self->length = 0;
            self->is_complete = true;
        } else if (self->length + 1 < sizeof self->line) {
            self->line[self->length++] = character;
        } else {
            self->is_complete = false; /* longer than any line of the board */
        }
    }
    return is_new;
}

/* The line is left out if the system has no room for it: the next one is as good. */
void serial_write_valve(struct serial *self)
{
    char line[64];
    int length = snprintf(line, sizeof line, "valve %.17g\n", self->valve);

    if (length > 0 && write(self->file, line, (size_t)length) < 0) {
        return;
    }
}
