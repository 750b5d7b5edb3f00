/* One writer and one reader; then no process writes. */
#include "script.h"

static script scripts[3];
static csp_channel channel;
static const char *const names[] = {"numbers"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 2U, 0U, 0U}};

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};
static const script_list writer = {
    {.action = WRITE, .medium = &channel.medium, .value = 7},
    {.action = DELAY, .value = 5},
    {.action = WRITE, .medium = &channel.medium, .value = 8},
};
static const script_list reader = {
    {.action = READ, .medium = &channel.medium},
    {.action = REPEAT, .jump = 0U, .value = 3},
};

int main(void)
{
    script_init(&scripts[0], 1U, "Top", top);
    script_init(&scripts[1], 2U, "Top.writer", writer);
    script_init(&scripts[2], 3U, "Top.reader", reader);
    csp_channel_init(&channel, 0U);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
