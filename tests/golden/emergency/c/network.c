/* SPDX-License-Identifier: 0BSD */
#include "network.h"
#include "csp_arithmetic.h"

static const double safe_control = 0.0;
static const bool safe_brake = true;
static const bool safe_halted = false;

static const csp_port port_table[] = {
    {
        .kind = CSP_PORT_EVENT,
        .medium = offsetof(struct network, external.panel.medium),
        .name = "Spindle.panel"
    },
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = offsetof(struct network, external.feedback.medium),
        .name = "Spindle.feedback"
    },
    {
        .kind = CSP_PORT_LATCHED,
        .medium = offsetof(struct network, external.control.medium),
        .safe = &safe_control,
        .name = "Spindle.control",
        .alike = 1U
    },
    {
        .kind = CSP_PORT_LATCHED,
        .medium = offsetof(struct network, external.brake.medium),
        .safe = &safe_brake,
        .name = "Spindle.brake"
    },
    {
        .kind = CSP_PORT_DIRECT,
        .medium = offsetof(struct network, external.halted.medium),
        .safe = &safe_halted,
        .name = "Spindle.halted"
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

const csp_program network_program = {
    .process = offsetof(struct network, top.process),
    .ports = port_table,
    .port_count = 5U,
    .grid = 2 * CSP_MS,
#if CSP_TRACE
    .process_name = process_name,
    .channel_name = channel_name,
#endif
};

void network_initialize(struct network *self, const struct network_drivers *drivers,
    const csp_hooks *hooks)
{
    csp_kernel *const csp = &self->kernel;
    csp_numbers numbers = {.csp = csp, .process = 1U, .channel = 0U};
    (void)memset(self, 0, sizeof(*self));
    csp_build(csp, &network_program, hooks);
    csp_event_input_init(&self->external.panel, 0U, false, &self->present.panel, &drivers->panel);
    csp_event_input_accept(&self->external.panel, &self->brought.panel,
        sizeof(self->brought.panel));
    csp_sampled_input_init(&self->external.feedback, 1U, 2 * CSP_MS, &self->present.feedback,
        &drivers->feedback);
    csp_latched_output_init(&self->external.control, 2U, 2 * CSP_MS, &self->present.control,
        &drivers->control);
    self->external.control.name = "Spindle.control";
    csp_latched_output_init(&self->external.brake, 3U, 2 * CSP_MS, &self->present.brake,
        &drivers->brake);
    self->external.brake.name = "Spindle.brake";
    csp_direct_output_init(&self->external.halted, 4U, &drivers->halted);
    self->external.halted.name = "Spindle.halted";
    numbers.channel = 5U;
    spindle_initialize(&self->top, &numbers,
        &(const struct spindle_ports){
            .panel = &self->external.panel,
            .feedback = &self->external.feedback,
            .control = &self->external.control,
            .brake = &self->external.brake,
            .halted = &self->external.halted
        });
}

bool network_bring_panel(struct network *self, enum emergency_button value)
{
    return csp_event_bring(&self->kernel, &self->external.panel, &value);
}
