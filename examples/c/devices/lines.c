/* SPDX-License-Identifier: 0BSD */
#define _DEFAULT_SOURCE

#include "lines.h"

#include <fcntl.h>
#include <linux/gpio.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* The file of a requested line, or -1. */
static int requested(int chip, int64_t line, uint64_t flags)
{
    struct gpio_v2_line_request request;

    (void)memset(&request, 0, sizeof request);
    request.offsets[0] = (uint32_t)line;
    request.num_lines = 1;
    request.config.flags = flags | GPIO_V2_LINE_FLAG_ACTIVE_LOW;
    (void)strcpy(request.consumer, "cspdiag");
    return ioctl(chip, GPIO_V2_GET_LINE_IOCTL, &request) == 0 ? request.fd : -1;
}

/* The button is pulled up; the lamp is off. Errors are printed. */
bool lines_open(struct lines *self, const char *chip, int64_t buttonLine, int64_t lampLine)
{
    int file = open(chip, O_RDWR | O_CLOEXEC);

    if (file < 0) {
        perror(chip); /* Permission denied: sudo usermod -aG gpio $USER */
        return false;
    }
    self->input = requested(file, buttonLine, GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_BIAS_PULL_UP);
    self->output = requested(file, lampLine, GPIO_V2_LINE_FLAG_OUTPUT);
    if (self->input < 0 || self->output < 0) {
        perror(chip); /* busy, or no such line: gpioinfo shows which */
        lines_close(self);
        (void)close(file);
        return false;
    }
    (void)close(file);
    return true;
}

void lines_close(struct lines *self)
{
    if (self->input >= 0) {
        (void)close(self->input);
    }
    if (self->output >= 0) {
        (void)close(self->output);
    }
}

bool lines_read_button(struct lines *self)
{
    struct gpio_v2_line_values values = {.mask = 1};

    if (ioctl(self->input, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) != 0) {
        return false; /* the chip was unplugged */
    }
    self->button = (values.bits & 1) != 0;
    return true;
}

void lines_write_lamp(struct lines *self)
{
    struct gpio_v2_line_values values = {.bits = self->lamp, .mask = 1};

    (void)ioctl(self->output, GPIO_V2_LINE_SET_VALUES_IOCTL, &values);
}
