/* Sampled inputs with their sessions and a missed sample, an event input, a latched output, safe values. */
#include "script.h"

#define MS INT64_C(1000000)

static script scripts[5];
static csp_sampled_input fast, slow;
static csp_sampled_end fast_end, slow_end, late_end;
static csp_event_input button;
static csp_event_end unused;
static csp_latched_output drive;
static int64_t fast_value, slow_value, button_value, drive_value;
static int64_t plant;
static bool pressed;
static const int64_t safe = -1;
static const char *const names[] = {"fast", "slow", "button", "drive"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 3U, 0U, 0U}};

static bool sample(void *device, void *value)
{
    (void)device;
    *(int64_t *)value = plant;
    return true;
}

static bool press(void *device, void *value)
{
    const bool event = pressed;
    (void)device;
    if (event) {
        *(int64_t *)value = plant;
    }
    pressed = false;
    return event;
}

static void put(void *device, const void *value)
{
    (void)device;
    (void)value;
}

static bool advance(csp_kernel *csp, void *state, int64_t now)
{
    (void)state;
    (void)csp;
    plant = now / MS;
    pressed = (now == 5 * MS) || (now == 6 * MS) || (now == 9 * MS);
    return true;
}

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};
static const script_list controller = {
    {.action = OFFER, .medium = &fast_end.medium},
    {.action = OFFER, .medium = &slow_end.medium},
    {.action = TOGETHER},
    {.action = WRITE, .medium = &drive.medium, .value = 10},
    {.action = WRITE, .medium = &drive.medium, .value = 11},
    {.action = READ, .medium = &fast_end.medium},
    {.action = REPEAT, .jump = 0U, .value = 3},
};
static const script_list slow_reader = {
    {.action = TRY, .exception = CSP_TIMEOUT_EXCEPTION, .jump = 4U},
    {.action = READ, .medium = &late_end.medium},
    {.action = DELAY, .value = 5},
    {.action = READ, .medium = &late_end.medium},
    {.action = SAY, .text = "has missed a sample"},
    {.action = READ, .medium = &late_end.medium},
    {.action = READ, .medium = &late_end.medium},
    {.action = DELAY, .value = 5},
    {.action = READ, .medium = &late_end.medium},
};
static script_list listener = {
    {.action = READ},
    {.action = DELAY, .value = 3},
    {.action = REPEAT, .jump = 0U, .value = 3},
};

int main(void)
{
    static csp_environment environment = {MS, NULL, advance, NULL, NULL};
    static const script_port ports[] = {
        {CSP_PORT_SAMPLED, &fast.medium, NULL},
        {CSP_PORT_SAMPLED, &slow.medium, NULL},
        {CSP_PORT_EVENT, &button.medium, NULL},
        {CSP_PORT_LATCHED, &drive.medium, &safe},
    };
    const csp_driver in = {NULL, sample, NULL};
    const csp_driver events = {NULL, press, NULL};
    const csp_driver out = {NULL, NULL, put};
    csp_sampled_input_init(&fast, 0U, 2 * MS, &fast_value, &in);
    csp_sampled_input_init(&slow, 1U, 4 * MS, &slow_value, &in);
    csp_event_input_init(&button, 2U, false, &button_value, &events);
    csp_latched_output_init(&drive, 3U, 2 * MS, &drive_value, &out);
    csp_sampled_end_init(&fast_end, &fast, &scripts[1].ends);
    csp_sampled_end_init(&slow_end, &slow, &scripts[1].ends);
    csp_sampled_end_init(&late_end, &fast, &scripts[2].ends);
    listener[0].medium = &csp_event_reader(&unused, &button)->medium;
    script_init(&scripts[0], 1U, "Top", top);
    script_init(&scripts[1], 2U, "controller", controller);
    script_init(&scripts[2], 3U, "slow reader", slow_reader);
    script_init(&scripts[3], 4U, "listener", listener);
    script_run(scripts, names, ports, 4U, &environment, 40 * MS);
    return 0;
}
