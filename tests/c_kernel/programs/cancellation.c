/* An exception cancels the siblings where they wait (each kind of waiting), and propagates to the catch; a nested call fails through its caller. */
#include "script.h"

enum { ALARM = CSP_FIRST_EXCEPTION, OTHER };

static script scripts[10];
static csp_channel never, work, two[2];
static csp_any_channel any;
static csp_alternative choice;
static csp_guard guards[2];
static csp_timer timer;
static const char *const names[] = {"never", "work", "two0", "two1", "any"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 7U, 0U, 0U}};
static const csp_branches below[] = {{sizeof(script), sizeof(script), 1U, 0U, 0U}};

static const script_list top = {
    {.action = TRY, .exception = ALARM, .jump = 2U},
    {.action = PARALLEL, .branches = branches, .branch_runs = 1U},
    {.action = SAY, .text = "caught"},
    {.action = WRITE, .medium = &any.medium, .value = 5},
};
static const script_list raises = {
    {.action = DELAY, .value = 2},
    {.action = CALL, .process = &scripts[9]},
    {.action = SAY, .text = "never"},
};
static const script_list called = {
    {.action = TRY, .exception = OTHER, .jump = 3U},
    {.action = WRITE, .medium = &work.medium, .value = 3},
    {.action = RAISE, .exception = ALARM},
    {.action = SAY, .text = "never"},
};
static const script_list reads = {{.action = READ, .medium = &never.medium}};
static const script_list works = {
    {.action = READ, .medium = &work.medium},
    {.action = SAY, .text = "continues to its next communication"},
    {.action = DELAY, .value = 0},
    {.action = SAY, .text = "never"},
};
static const script_list delays = {{.action = DELAY, .value = 10}, {.action = SAY, .text = "never"}};
static const script_list chooses = {{.action = SELECT, .alternative = &choice, .jump = 1U}};
static const script_list offers = {
    {.action = OFFER, .medium = &two[0].medium, .value = 1, .writes = true},
    {.action = OFFER, .medium = &two[1].medium, .value = 2, .writes = true},
    {.action = TOGETHER},
};
static const script_list parallel = {{.action = PARALLEL, .branches = below, .branch_runs = 1U}};
static const script_list stops = {{.action = STOP}};

int main(void)
{
    const script_step *const lists[] = {top, raises, reads, works, delays, chooses, offers, parallel, stops, called};
    static const char *const process_names[] = {"Top",    "raises",   "reads", "works", "delays", "chooses",
                                                "offers", "parallel", "stops", "called"};
    for (uint32_t index = 0U; index < 10U; index++) {
        script_init(&scripts[index], index + 1U, process_names[index], lists[index]);
    }
    csp_channel_init(&never, 0U);
    csp_channel_init(&work, 1U);
    csp_channel_init(&two[0], 2U);
    csp_channel_init(&two[1], 3U);
    csp_any_init(&any, 4U);
    csp_alternative_init(&choice, guards, 2U, NULL, false);
    csp_guard_read(&choice, 0U, &any.medium, &scripts[5].value, sizeof(int64_t));
    csp_guard_after(&choice, 1U, &timer);
    csp_delay(&choice, 1U, 50000000);
    csp_enable_all(&choice);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
