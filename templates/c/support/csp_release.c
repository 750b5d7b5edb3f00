/* SPDX-License-Identifier: 0BSD */
/* Calls of device functions, and safe values: each output gets its safe value once, as its last value, however the run ends. */
#include "csp_internal.h"
#include "csp_shared.h"

void csp_begin_driving(csp_kernel *csp)
{
    CSP_STORE(csp->next_port, 0U);
    CSP_STORE(csp->closed, false);
    CSP_STORE(csp->driving, true);
}

void csp_forget_outputs(csp_kernel *csp)
{
    if (csp == NULL) {
        return;
    }
    CSP_STORE(csp->closed, true);
    CSP_STORE(csp->driving, false);
}

bool csp_is_driving(csp_kernel *csp)
{
    return (csp != NULL) && CSP_LOAD(csp->driving);
}

bool csp_is_releasing(csp_kernel *csp)
{
    return CSP_LOAD(csp->closed);
}

csp_calls csp_calls_now(csp_kernel *csp)
{
    if (csp == NULL) {
        return (csp_calls){false, NULL, false, 0U};
    }
    const csp_calls calls = {CSP_LOAD(csp->driving), CSP_LOAD(csp->called), CSP_LOAD(csp->closed), CSP_LOAD(csp->next_port)};
    return calls;
}

static void release_port(csp_kernel *csp, const csp_port *port)
{
    if (port->safe == NULL) {
        return;
    }
    const csp_medium *const medium = csp_medium_of(csp, port);
    const csp_driver *driver = NULL;
    if ((CSP_USES_LATCHED_OUTPUTS != 0) && (port->kind == CSP_PORT_LATCHED)) {
        driver = &((const csp_latched_output *)(const void *)medium)->driver;
    } else {
        driver = &((const csp_direct_output *)(const void *)medium)->driver;
    }
    if (driver->write != NULL) {
        CSP_NOTE(csp->called, medium);
        driver->write(driver->device, port->safe);
        CSP_NOTE(csp->called, NULL);
    }
    csp_observe_release(csp, medium->number, port->safe);
}

/* If a device function fails here, a handler calls this function again, which continues with the next port. */
void csp_release_outputs(csp_kernel *csp)
{
    if (!csp_is_driving(csp)) {
        return;
    }
    CSP_STORE(csp->closed, true);
    for (uint32_t index = CSP_COUNT(csp->next_port); index < csp->program->port_count; index = CSP_COUNT(csp->next_port)) {
        release_port(csp, &csp->program->ports[index]);
    }
    CSP_STORE(csp->driving, false);
}
