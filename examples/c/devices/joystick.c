/* SPDX-License-Identifier: 0BSD */
#define _DEFAULT_SOURCE

#include "joystick.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/input.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <unistd.h>

static double *axis(struct joystick *self, unsigned at)
{
    return at == ABS_X ? &self->x : &self->y;
}

static void move(struct joystick *self, unsigned at, int32_t value)
{
    double range = (double)self->most[at] - self->least[at];

    *axis(self, at) = range > 0 ? 2 * ((double)value - self->least[at]) / range - 1 : 0;
}

/* The ranges of both axes and where they are. What has no ranges, such as a recording of events, has those of 16 bits. */
static void ask(struct joystick *self)
{
    for (unsigned at = ABS_X; at <= ABS_Y; at++) {
        struct input_absinfo found = {.minimum = -32768, .maximum = 32767};

        (void)ioctl(self->file, EVIOCGABS(at), &found);
        self->least[at] = found.minimum;
        self->most[at] = found.maximum;
        move(self, at, found.value);
    }
}

/* Errors are printed. */
bool joystick_open(struct joystick *self, const char *path)
{
    self->file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (self->file < 0) {
        perror(path); /* Permission denied: sudo usermod -aG input $USER */
        return false;
    }
    self->buttons = 0;
    self->is_there = true;
    ask(self);
    return true;
}

void joystick_close(struct joystick *self)
{
    (void)close(self->file);
}

static void press(struct joystick *self, unsigned code, bool is_pressed)
{
    if (code >= BTN_JOYSTICK && code < BTN_DIGI) {
        int64_t bit = INT64_C(1) << (code & 0xF); /* joysticks and gamepads have sixteen each */

        self->buttons = is_pressed ? self->buttons | bit : self->buttons & ~bit;
    }
}

/* Takes all events that have come. Whether it is still plugged in. */
static bool update(struct joystick *self)
{
    struct input_event event;

    errno = 0;
    while (self->is_there && read(self->file, &event, sizeof event) == (ssize_t)sizeof event) {
        if (event.type == EV_ABS && event.code <= ABS_Y) {
            move(self, event.code, event.value);
        } else if (event.type == EV_KEY) {
            press(self, event.code, event.value != 0);
        } else if (event.type == EV_SYN && event.code == SYN_DROPPED) {
            ask(self); /* more than Linux keeps */
        }
    }
    self->is_there = self->is_there && errno != ENODEV;
    return self->is_there;
}

/* Without the device there is no sample: the program raises Timeout, or counts, as its environment says. */
bool joystick_read_x(struct joystick *self)
{
    return update(self);
}

bool joystick_read_y(struct joystick *self)
{
    return update(self);
}

bool joystick_read_buttons(struct joystick *self)
{
    return update(self);
}
