/* Calls of device functions, and safe values: each output gets its safe value once, as its last value, however the run ends. */
#include "csp_internal.h"
#include "csp_shared.h"

static const csp_program *volatile driving; /* the program whose outputs are not released; NULL: none */
static volatile uint32_t next_port;         /* the next port to get its safe value */
volatile bool csp_closed;
const csp_medium *volatile csp_called;

void csp_begin_driving(const csp_program *program)
{
    CSP_STORE(next_port, 0U);
    CSP_STORE(csp_closed, false);
    CSP_STORE(driving, program);
}

void csp_forget_outputs(void)
{
    CSP_STORE(csp_closed, true);
    CSP_STORE(driving, NULL);
}

bool csp_is_driving(void)
{
    return CSP_LOAD(driving) != NULL;
}

csp_calls csp_calls_now(void)
{
    const csp_calls calls = {CSP_LOAD(driving), CSP_LOAD(csp_called), CSP_LOAD(csp_closed), CSP_LOAD(next_port)};
    return calls;
}

static void release_port(const csp_port *port)
{
    if (port->safe == NULL) {
        return;
    }
    const csp_driver *driver = NULL;
    if (port->kind == CSP_PORT_LATCHED) {
        driver = &((const csp_latched_output *)(const void *)port->medium)->driver;
    } else {
        driver = &((const csp_direct_output *)(const void *)port->medium)->driver;
    }
    if (driver->write != NULL) {
        CSP_NOTE(csp_called, port->medium);
        driver->write(driver->device, port->safe);
        CSP_NOTE(csp_called, NULL);
    }
    csp_observe_release(port->medium->number, port->safe);
}

/* If a device function fails here, a handler calls this function again, which continues with the next port. */
void csp_release_outputs(void)
{
    const csp_program *const program = CSP_LOAD(driving);
    if (program == NULL) {
        return;
    }
    CSP_STORE(csp_closed, true);
    for (uint32_t index = CSP_COUNT(next_port); index < program->port_count; index = CSP_COUNT(next_port)) {
        release_port(&program->ports[index]);
    }
    CSP_STORE(driving, NULL);
}
