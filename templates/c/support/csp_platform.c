/* SPDX-License-Identifier: 0BSD */
/* What joins a run to its platform: the hooks that call the functions of csp_port.h, and which run the platform's handlers stop and release. */
#include "csp_internal.h"
#include "csp_port.h"
#include "csp_shared.h"

static csp_kernel *volatile owned;

void csp_own(csp_kernel *csp)
{
    CSP_STORE(owned, csp);
}

csp_kernel *csp_owned(void)
{
    return CSP_LOAD(owned);
}

/* ---- The hooks of a platform ---- */

static uint32_t lock(void *context)
{
    (void)context;
    return csp_port_enter_critical();
}

static void unlock(void *context, uint32_t outside)
{
    (void)context;
    csp_port_leave_critical(outside);
}

static void wake(void *context)
{
    (void)context;
    csp_port_wake();
}

static void alive(void *context)
{
    (void)context;
    csp_port_alive();
}

static void met(void *context, int64_t instant)
{
    (void)context;
    csp_port_met(instant);
}

const csp_hooks *csp_port_hooks(void)
{
    static const csp_hooks in_virtual_time = {NULL, false, lock, unlock, wake, alive, NULL, NULL, NULL, NULL, 0};
    static const csp_hooks in_real_time = {NULL, true, lock, unlock, wake, alive, met, NULL, NULL, NULL, 0};
    return csp_port_virtual_time ? &in_virtual_time : &in_real_time;
}
