/* SPDX-License-Identifier: 0BSD
 *
 * Two frames of a CAN bus, with SocketCAN of Linux.
 */
#ifndef CAN_H
#define CAN_H

#include <stdbool.h>

struct can {
    double level; /* the ports */
    double valve;
    int socket;
};

bool can_open(struct can *self, const char *bus);
void can_close(struct can *self);
bool can_read_level(struct can *self);
void can_write_valve(struct can *self);

#endif
