#include "network.h"

#include "constants.h"
#include "spindle.h"

/* All memory of the program. */
static struct spindle spindle;
static struct {
    csp_event_input panel;
    csp_sampled_input feedback;
    csp_latched_output control;
    csp_latched_output brake;
    csp_direct_output halted;
} external;
static struct {
    enum button panel;
    double feedback;
    double control;
    bool brake;
} present;
static struct {
    enum button panel;
} brought; /* by interrupt handlers */

static const double safe_control = 0.0;
static const bool safe_brake = true;
static const bool safe_halted = false;

static const csp_port port_table[] = {
    {.kind = CSP_PORT_EVENT, .medium = &external.panel.medium, .name = "Spindle.panel"},
    {.kind = CSP_PORT_SAMPLED, .medium = &external.feedback.medium, .name = "Spindle.feedback"},
    {
        .kind = CSP_PORT_LATCHED,
        .medium = &external.control.medium,
        .safe = &safe_control,
        .name = "Spindle.control"
    },
    {
        .kind = CSP_PORT_LATCHED,
        .medium = &external.brake.medium,
        .safe = &safe_brake,
        .name = "Spindle.brake"
    },
    {
        .kind = CSP_PORT_DIRECT,
        .medium = &external.halted.medium,
        .safe = &safe_halted,
        .name = "Spindle.halted"
    }
};

void network_initialize(const struct network_drivers *drivers)
{
    csp_numbers numbers = {.process = 1U, .channel = 0U};
    csp_begin_building();
    (void)memset(&spindle, 0, sizeof(spindle));
    (void)memset(&external, 0, sizeof(external));
    csp_event_input_init(&external.panel, 0U, false, &present.panel, drivers->panel);
    csp_event_input_accept(&external.panel, &brought.panel, sizeof(brought.panel));
    csp_sampled_input_init(&external.feedback, 1U, 2 * CSP_MS, &present.feedback,
        drivers->feedback);
    csp_latched_output_init(&external.control, 2U, 2 * CSP_MS, &present.control, drivers->control);
    external.control.name = "Spindle.control";
    csp_latched_output_init(&external.brake, 3U, 2 * CSP_MS, &present.brake, drivers->brake);
    external.brake.name = "Spindle.brake";
    csp_direct_output_init(&external.halted, 4U, drivers->halted);
    external.halted.name = "Spindle.halted";
    numbers.channel = 5U;
    spindle_initialize(&spindle, &numbers,
        &(const struct spindle_ports){
            .panel = &external.panel,
            .feedback = &external.feedback,
            .control = &external.control,
            .brake = &external.brake,
            .halted = &external.halted
        });
}

void network_bring_panel(enum button value)
{
    csp_event_bring(&external.panel, &value);
}

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
    .process = &spindle.process,
    .ports = port_table,
    .port_count = 5U,
#if CSP_TRACE
    .process_name = process_name,
    .channel_name = channel_name,
#endif
};
