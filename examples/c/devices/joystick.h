/* SPDX-License-Identifier: 0BSD
 *
 * A gamepad or joystick, with the events of Linux (evdev).
 */
#ifndef JOYSTICK_H
#define JOYSTICK_H

#include <stdbool.h>
#include <stdint.h>

struct joystick {
    double x; /* the ports: -1 to 1, right and down are positive */
    double y;
    int64_t buttons;
    int file;
    int32_t least[2]; /* of each axis, */
    int32_t most[2];
    bool is_there;
};

bool joystick_open(struct joystick *self, const char *path);
void joystick_close(struct joystick *self);
bool joystick_read_x(struct joystick *self);
bool joystick_read_y(struct joystick *self);
bool joystick_read_buttons(struct joystick *self);

#endif
