#include "network.h"

#include "constants.h"
#include "jiwy.h"

/* All memory of the program. */
static struct jiwy jiwy;
static struct {
    csp_sampled_input joystick_horizontal;
    csp_sampled_input joystick_vertical;
    csp_event_input joystick_buttons;
    csp_sampled_input feedback_horizontal;
    csp_sampled_input feedback_vertical;
    csp_latched_output control_horizontal;
    csp_latched_output control_vertical;
} external;
static struct {
    double joystick_horizontal;
    double joystick_vertical;
    int64_t joystick_buttons;
    double feedback_horizontal;
    double feedback_vertical;
    double control_horizontal;
    double control_vertical;
} present;
static struct {
    int64_t joystick_buttons;
} brought; /* by interrupt handlers */

static const double safe_control_horizontal = 0.0;
static const double safe_control_vertical = 0.0;

static const csp_port port_table[] = {
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = &external.joystick_horizontal.medium,
        .name = "Jiwy.joystick_horizontal"
    },
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = &external.joystick_vertical.medium,
        .name = "Jiwy.joystick_vertical"
    },
    {
        .kind = CSP_PORT_EVENT,
        .medium = &external.joystick_buttons.medium,
        .name = "Jiwy.joystick_buttons"
    },
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = &external.feedback_horizontal.medium,
        .name = "Jiwy.feedback_horizontal"
    },
    {
        .kind = CSP_PORT_SAMPLED,
        .medium = &external.feedback_vertical.medium,
        .name = "Jiwy.feedback_vertical"
    },
    {
        .kind = CSP_PORT_LATCHED,
        .medium = &external.control_horizontal.medium,
        .safe = &safe_control_horizontal,
        .name = "Jiwy.control_horizontal"
    },
    {
        .kind = CSP_PORT_LATCHED,
        .medium = &external.control_vertical.medium,
        .safe = &safe_control_vertical,
        .name = "Jiwy.control_vertical"
    }
};

void network_initialize(const struct network_drivers *drivers)
{
    csp_numbers numbers = {.process = 1U, .channel = 0U};
    csp_begin_building();
    (void)memset(&jiwy, 0, sizeof(jiwy));
    (void)memset(&external, 0, sizeof(external));
    csp_sampled_input_init(&external.joystick_horizontal, 0U, 2 * CSP_MS,
        &present.joystick_horizontal, drivers->joystick_horizontal);
    csp_sampled_input_init(&external.joystick_vertical, 1U, CSP_MS, &present.joystick_vertical,
        drivers->joystick_vertical);
    csp_event_input_init(&external.joystick_buttons, 2U, true, &present.joystick_buttons,
        drivers->joystick_buttons);
    csp_event_input_accept(&external.joystick_buttons, &brought.joystick_buttons,
        sizeof(brought.joystick_buttons));
    csp_sampled_input_init(&external.feedback_horizontal, 3U, 2 * CSP_MS,
        &present.feedback_horizontal, drivers->feedback_horizontal);
    csp_sampled_input_init(&external.feedback_vertical, 4U, CSP_MS, &present.feedback_vertical,
        drivers->feedback_vertical);
    csp_latched_output_init(&external.control_horizontal, 5U, 2 * CSP_MS,
        &present.control_horizontal, drivers->control_horizontal);
    external.control_horizontal.name = "Jiwy.control_horizontal";
    csp_latched_output_init(&external.control_vertical, 6U, CSP_MS, &present.control_vertical,
        drivers->control_vertical);
    external.control_vertical.name = "Jiwy.control_vertical";
    numbers.channel = 7U;
    jiwy_initialize(&jiwy, &numbers,
        &(const struct jiwy_ports){
            .joystick_horizontal = &external.joystick_horizontal,
            .joystick_vertical = &external.joystick_vertical,
            .joystick_buttons = &external.joystick_buttons,
            .feedback_horizontal = &external.feedback_horizontal,
            .feedback_vertical = &external.feedback_vertical,
            .control_horizontal = &external.control_horizontal,
            .control_vertical = &external.control_vertical
        });
}

void network_bring_joystick_buttons(int64_t value)
{
    csp_event_bring(&external.joystick_buttons, &value);
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

static const char *const exception_names[] = {"ModeFailed"};

const csp_program network_program = {
    .process = &jiwy.process,
    .ports = port_table,
    .port_count = 7U,
    .exception_names = exception_names,
#if CSP_TRACE
    .process_name = process_name,
    .channel_name = channel_name,
#endif
};
