/* SPDX-License-Identifier: 0BSD */
#define _DEFAULT_SOURCE

#include "can.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <math.h>
#include <net/if.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { LEVEL = 0x100, VALVE = 0x200 };

static const double step = 0.25;

/* Only frames with the level are received. Errors are printed. */
bool can_open(struct can *self, const char *bus)
{
    struct sockaddr_can address = {.can_family = AF_CAN};
    struct can_filter filter = {.can_id = LEVEL, .can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG};

    self->socket = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW);
    if (self->socket < 0) {
        perror("CAN");
        return false;
    }
    address.can_ifindex = (int)if_nametoindex(bus);
    if (address.can_ifindex == 0
        || setsockopt(self->socket, SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter) != 0
        || bind(self->socket, (const struct sockaddr *)&address, sizeof address) != 0) {
        perror(bus); /* No such device: sudo ip link set can0 up type can bitrate 500000 */
        (void)close(self->socket);
        return false;
    }
    return true;
}

void can_close(struct can *self)
{
    (void)close(self->socket);
}

/* Whether a frame has come since the last one; the latest is taken. */
bool can_read_level(struct can *self)
{
    struct can_frame frame;
    bool is_new = false;

    while (read(self->socket, &frame, sizeof frame) == (ssize_t)sizeof frame) {
        if (frame.can_dlc >= 2) {
            unsigned bits = frame.data[0] | (unsigned)frame.data[1] << 8;

            self->level = step * (bits < 0x8000 ? (int)bits : (int)bits - 0x10000);
            is_new = true;
        }
    }
    return is_new;
}

/* The frame is left out if the queue is full, as it is when nobody acknowledges. */
void can_write_valve(struct can *self)
{
    struct can_frame frame;
    int16_t value = (int16_t)lrint(fmax(INT16_MIN, fmin(self->valve / step, INT16_MAX)));

    (void)memset(&frame, 0, sizeof frame);
    frame.can_id = VALVE;
    frame.can_dlc = 2;
    frame.data[0] = (uint8_t)((uint16_t)value & 0xFF);
    frame.data[1] = (uint8_t)((uint16_t)value >> 8);
    if (write(self->socket, &frame, sizeof frame) < 0) {
        return;
    }
}
