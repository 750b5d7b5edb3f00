/* Writes its output forever, and counts the events that signals bring; ends by SIGTERM, which releases the output. */
#define _POSIX_C_SOURCE 200112L

#include "script.h"

#include <signal.h>
#include <stdio.h>

static script scripts[3];
static csp_latched_output drive;
static csp_event_input button;
static int64_t drive_value, button_value, brought_value;
static const int64_t safe = -1;
static const char *const names[] = {"drive", "button"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 2U, 0U, 0U}};

static void press(int number)
{
    static int64_t pressed;
    (void)number;
    pressed++;
    (void)csp_event_bring(&script_kernel, &button, &pressed);
}

static void put(void *device, const void *value)
{
    (void)device;
    (void)value;
}

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};
static const script_list writer = {
    {.action = WRITE, .medium = &drive.medium, .value = 3},
    {.action = DELAY, .value = 2},
    {.action = JUMP, .jump = 0U},
};
static script_list listener = {
    {.action = READ},
    {.action = SAY, .text = "pressed"},
    {.action = JUMP, .jump = 0U},
};

int main(void)
{
    static const script_port ports[] = {
        {CSP_PORT_LATCHED, &drive.medium, &safe},
        {CSP_PORT_EVENT, &button.medium, NULL},
    };
    const csp_driver out = {NULL, NULL, put};
    const csp_driver none = {NULL, NULL, NULL};
    (void)setvbuf(stdout, NULL, _IOLBF, 0U);
    (void)signal(SIGUSR1, press);
    csp_latched_output_init(&drive, 0U, INT64_C(1000000), &drive_value, &out);
    csp_event_input_init(&button, 1U, false, &button_value, &none);
    csp_event_input_accept(&button, &brought_value, sizeof(brought_value));
    listener[0].medium = &csp_event_reader(NULL, &button)->medium;
    script_init(&scripts[0], 1U, "Top", top);
    script_init(&scripts[1], 2U, "writer", writer);
    script_init(&scripts[2], 3U, "listener", listener);
    script_run(scripts, names, ports, 2U, NULL, -1);
    return 0;
}
