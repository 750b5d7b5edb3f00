/* SPDX-License-Identifier: 0BSD */
#include "network.h"

static const double safe_control_horizontal = 0.0;
static const double safe_control_vertical = 0.0;

static const csp_port port_table[] = {
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = offsetof(struct network, external.joystick_horizontal.medium),
        .name = "Jiwy.joystick_horizontal"
    },
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = offsetof(struct network, external.joystick_vertical.medium),
        .name = "Jiwy.joystick_vertical"
    },
    {
        .kind = CSP_PORT_EVENT,
        .medium = offsetof(struct network, external.joystick_buttons.medium),
        .name = "Jiwy.joystick_buttons"
    },
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = offsetof(struct network, external.feedback_horizontal.medium),
        .name = "Jiwy.feedback_horizontal"
    },
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = offsetof(struct network, external.feedback_vertical.medium),
        .name = "Jiwy.feedback_vertical"
    },
    {
        .kind = CSP_PORT_LATCHED,
        .medium = offsetof(struct network, external.control_horizontal.medium),
        .safe = &safe_control_horizontal,
        .name = "Jiwy.control_horizontal"
    },
    {
        .kind = CSP_PORT_LATCHED,
        .medium = offsetof(struct network, external.control_vertical.medium),
        .safe = &safe_control_vertical,
        .name = "Jiwy.control_vertical"
    }
};

/* Names are built in where communications are reported. */
#if CSP_TRACE
static void copy_name(const char *name, char *text, size_t size)
{
    size_t length = strlen(name);
    if (length >= size) {
        length = size - 1U;
    }
    (void)memcpy(text, name, length);
    text[length] = '\0';
}

static void process_name(uint32_t number, char *text, size_t size)
{
    copy_name(network_process_names[number], text, size);
}

static void channel_name(uint32_t number, char *text, size_t size)
{
    copy_name(network_channel_names[number], text, size);
}
#endif

/* The values of the text. */
const struct jiwy_parameters network_default_parameters = {
    .panGains = {
        .kp = 2.6,
        .tauD = 50 * CSP_MS,
        .beta = 0.17,
        .tauI = 9 * CSP_S,
        .friction = 0.25,
        .tolerance = 0.004
    },
    .tiltGains = {
        .kp = 1.6,
        .tauD = 50 * CSP_MS,
        .beta = 0.001,
        .tauI = 10500 * CSP_MS,
        .friction = 0.165,
        .tolerance = 0.015
    }
};

static bool refuse(struct network *self, csp_refusal_cause cause, uint16_t parameter)
{
    self->refusal.cause = (uint16_t)cause;
    self->refusal.parameter = parameter;
    self->kernel.fault.describe = NULL;
    return false;
}

/* Tests the parameters, and computes what follows from them; false: they are refused. */
static bool follow(struct network *self)
{
    csp_kernel *const csp = &self->kernel;
    csp->changes++;
    jiwy_servo_gains_finite(csp, self->parameters.panGains, "panGains");
    if (csp_faulted(csp)) {
        return refuse(self, CSP_NOT_FINITE, 0U);
    }
    jiwy_servo_gains_finite(csp, self->parameters.tiltGains, "tiltGains");
    if (csp_faulted(csp)) {
        return refuse(self, CSP_NOT_FINITE, 1U);
    }
    return true;
}

bool network_change_parameters(struct network *self, const struct jiwy_parameters *parameters)
{
    const struct jiwy_parameters before = self->parameters;
    self->parameters = *parameters;
    self->refusal.cause = (uint16_t)CSP_ACCEPTED;
    if (follow(self)) {
        return true;
    }
    self->parameters = before;
    (void)follow(self);
    return false;
}

static bool set_parameters(csp_kernel *csp, const void *parameters)
{
    return network_change_parameters(CSP_ENCLOSING(csp, struct network, kernel), parameters);
}

static const char *const exception_names[] = {"ModeFailed"};

const csp_program network_program = {
    .process = offsetof(struct network, top.process),
    .ports = port_table,
    .port_count = 7U,
    .grid = CSP_MS,
    .exception_names = exception_names,
#if CSP_USES_TEXTS
    .variable_names = network_variable_names,
#endif
    .parameters = offsetof(struct network, parameters),
    .parameters_size = sizeof(struct jiwy_parameters),
    .set_parameters = set_parameters,
#if CSP_TRACE
    .process_name = process_name,
    .channel_name = channel_name,
#endif
};

void network_initialize(struct network *self, const struct network_drivers *drivers,
    const csp_hooks *hooks, const struct jiwy_parameters *parameters)
{
    csp_kernel *const csp = &self->kernel;
    csp_numbers numbers = {.csp = csp, .process = 1U, .channel = 0U};
    (void)memset(self, 0, sizeof(*self));
    csp_build(csp, &network_program, hooks);
    self->parameters = network_default_parameters;
    (void)follow(self);
    if (parameters != NULL) {
        (void)network_change_parameters(self, parameters);
    }
    csp_sampled_input_init(&self->external.joystick_horizontal, 0U, 2 * CSP_MS,
        &self->present.joystick_horizontal, &drivers->joystick_horizontal);
    csp_sampled_input_init(&self->external.joystick_vertical, 1U, CSP_MS,
        &self->present.joystick_vertical, &drivers->joystick_vertical);
    csp_event_input_init(&self->external.joystick_buttons, 2U, true,
        &self->present.joystick_buttons, &drivers->joystick_buttons);
    csp_event_input_accept(&self->external.joystick_buttons, &self->brought.joystick_buttons,
        sizeof(self->brought.joystick_buttons));
    csp_sampled_input_init(&self->external.feedback_horizontal, 3U, 2 * CSP_MS,
        &self->present.feedback_horizontal, &drivers->feedback_horizontal);
    csp_sampled_input_init(&self->external.feedback_vertical, 4U, CSP_MS,
        &self->present.feedback_vertical, &drivers->feedback_vertical);
    csp_latched_output_init(&self->external.control_horizontal, 5U, 2 * CSP_MS,
        &self->present.control_horizontal, &drivers->control_horizontal);
    self->external.control_horizontal.name = "Jiwy.control_horizontal";
    csp_latched_output_init(&self->external.control_vertical, 6U, CSP_MS,
        &self->present.control_vertical, &drivers->control_vertical);
    self->external.control_vertical.name = "Jiwy.control_vertical";
    numbers.channel = 7U;
    jiwy_initialize(&self->top, &numbers,
        &(const struct jiwy_ports){
            .joystick_horizontal = &self->external.joystick_horizontal,
            .joystick_vertical = &self->external.joystick_vertical,
            .joystick_buttons = &self->external.joystick_buttons,
            .feedback_horizontal = &self->external.feedback_horizontal,
            .feedback_vertical = &self->external.feedback_vertical,
            .control_horizontal = &self->external.control_horizontal,
            .control_vertical = &self->external.control_vertical
        },
        &self->parameters.panGains, &self->parameters.tiltGains);
}

bool network_bring_joystick_buttons(struct network *self, int64_t value)
{
    return csp_event_bring(&self->kernel, &self->external.joystick_buttons, &value);
}
