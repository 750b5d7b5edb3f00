/* Safe values: every output is handed its own once, however the run ends. */
#include "csp_internal.h"

static const csp_program *volatile driving; /* the program whose outputs are not released; NULL: none */
static volatile uint32_t next_port;         /* that is handed its safe value */

void csp_begin_driving(const csp_program *program)
{
    next_port = 0U;
    driving = program;
}

bool csp_is_driving(void)
{
    return driving != NULL;
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
        driver->write(driver->device, port->safe);
    }
    csp_observe_release(port->medium->number, port->safe);
}

/* A device function that fails in here ends in a handler that calls this again: it goes on with the next port. */
void csp_release_outputs(void)
{
    const csp_program *const program = driving;
    if (program == NULL) {
        return;
    }
    while (next_port < program->port_count) {
        const uint32_t index = next_port;
        next_port = index + 1U;
        release_port(&program->ports[index]);
    }
    driving = NULL;
}
