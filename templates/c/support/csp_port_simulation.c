/* SPDX-License-Identifier: 0BSD */
/* The port for simulation: time is virtual, so it never waits. */
#include "csp_port.h"

#include <stdio.h>
#include <stdlib.h>

const bool csp_port_virtual_time = true;

void csp_port_start(void)
{
}

void csp_port_finish(struct csp_kernel *csp)
{
    (void)csp;
}

__attribute__((weak)) void csp_port_alive(void)
{
}

int64_t csp_port_now(void)
{
    return 0;
}

void csp_port_wait_until(int64_t instant)
{
    (void)instant;
}

void csp_port_met(int64_t instant)
{
    (void)instant;
}

void csp_port_wake(void)
{
}

uint32_t csp_port_enter_critical(void)
{
    return 0U;
}

void csp_port_leave_critical(uint32_t outside)
{
    (void)outside;
}

void csp_port_fatal(const char *message)
{
    (void)fprintf(stderr, "%s\n", message);
    exit(EXIT_FAILURE);
}
