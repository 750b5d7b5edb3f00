/* A writing alternative has chosen a reader that is only ready, and is cancelled before that reads; run again, it waits as before. */
#include "script.h"

static script scripts[5];
static csp_any_channel channel;
static csp_alternative writing, reading;
static csp_guard writing_guards[1], reading_guards[1];
static int64_t offered = 5;
static const char *const names[] = {"channel"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 2U, 0U, 0U}};

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};
static const script_list patient = {
    {.action = INTERRUPT, .process = &scripts[3], .rank = 2, .jump = 2U},
    {.action = SAY, .text = "never"},
    {.action = SAY, .text = "cancelled the writer"},
    {.action = INTERRUPT, .process = &scripts[3], .rank = 40, .jump = 5U},
    {.action = SAY, .text = "the writer has ended"},
    {.action = SAY, .text = "ends"},
};
static const script_list reader = {
    {.action = SELECT, .alternative = &reading, .jump = 1U},
    {.action = SAY, .text = "ready"},
    {.action = DELAY, .value = 10},
    {.action = READ, .medium = &channel.medium},
    {.action = SAY, .text = "read"},
};
static const script_list writer = {
    {.action = SELECT, .alternative = &writing, .jump = 1U},
    {.action = SAY, .text = "wrote"},
};

int main(void)
{
    script_init(&scripts[0], 1U, "Top", top);
    script_init(&scripts[1], 2U, "patient", patient);
    script_init(&scripts[2], 3U, "reader", reader);
    script_init(&scripts[3], 4U, "writer", writer);
    csp_any_init(&channel, 0U);
    csp_alternative_init(&writing, writing_guards, 1U, NULL, false);
    csp_guard_write(&writing, 0U, &channel.medium, &offered, sizeof(offered));
    csp_enable_all(&writing);
    csp_alternative_init(&reading, reading_guards, 1U, NULL, false);
    csp_guard_ready(&reading, 0U, &channel.medium);
    csp_enable_all(&reading);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
