/* The guard of an interrupt is promised to a reader; when the body has ended, and before the interrupt continues, everything is cancelled. */
#include "script.h"

enum { ALARM = CSP_FIRST_EXCEPTION };

static script scripts[6];
static csp_any_channel promised;
static csp_channel alarm;
static csp_alternative reading;
static csp_guard reading_guards[1];
static const char *const names[] = {"promised", "alarm"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 4U, 0U, 0U}};

static const script_list top = {
    {.action = TRY, .exception = ALARM, .jump = 2U},
    {.action = PARALLEL, .branches = branches, .branch_runs = 1U},
    {.action = SAY, .text = "continues"},
};
static const script_list interrupted = {
    {.action = INTERRUPT, .process = &scripts[5], .medium = &promised.medium, .writes = true, .value = 5, .jump = 2U},
    {.action = SAY, .text = "never"},
    {.action = SAY, .text = "never"},
};
static const script_list reader = {
    {.action = DELAY, .value = 5},
    {.action = SELECT, .alternative = &reading, .jump = 2U},
    {.action = STOP},
};
static const script_list warns = {
    {.action = DELAY, .value = 5},
    {.action = WRITE, .medium = &alarm.medium, .value = 1},
};
static const script_list raises = {
    {.action = READ, .medium = &alarm.medium},
    {.action = RAISE, .exception = ALARM},
};
static const script_list body = {{.action = STOP}};

int main(void)
{
    script_init(&scripts[0], 1U, "Top", top);
    script_init(&scripts[1], 2U, "interrupted", interrupted);
    script_init(&scripts[2], 3U, "reader", reader);
    script_init(&scripts[3], 4U, "warns", warns);
    script_init(&scripts[4], 5U, "raises", raises);
    script_init(&scripts[5], 6U, "body", body);
    csp_any_init(&promised, 0U);
    csp_channel_init(&alarm, 1U);
    csp_alternative_init(&reading, reading_guards, 1U, NULL, false);
    csp_guard_ready(&reading, 0U, &promised.medium);
    csp_enable_all(&reading);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
