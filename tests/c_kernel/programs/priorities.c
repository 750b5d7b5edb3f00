/* A prioritized parallel: the process with the higher priority runs first once it is ready; timers of one instant in the order in which they began. */
#include "script.h"

static script scripts[4];
static csp_channel channel;
static const char *const names[] = {"channel"};
static const csp_branches branches[] = {
    {sizeof(script), 0U, 1U, 0U, 0U}, {2U * sizeof(script), 0U, 1U, 1U, 0U}, {3U * sizeof(script), 0U, 1U, 2U, 0U}};

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 3U}};
static const script_list urgent = {
    {.action = READ, .medium = &channel.medium},
    {.action = SAY, .text = "urgent"},
    {.action = DELAY, .value = 2},
    {.action = REPEAT, .jump = 0U, .value = 2},
};
static const script_list middle = {
    {.action = DELAY, .value = 2},
    {.action = SAY, .text = "middle"},
    {.action = DELAY, .value = 0},
    {.action = SAY, .text = "middle continues"},
};
static const script_list idle = {
    {.action = WRITE, .medium = &channel.medium, .value = 1},
    {.action = SAY, .text = "has written, and runs until it must wait"},
    {.action = WRITE, .medium = &channel.medium, .value = 2},
    {.action = SAY, .text = "idle"},
};

int main(void)
{
    script_init(&scripts[0], 1U, "Top", top);
    script_init(&scripts[1], 2U, "urgent", urgent);
    script_init(&scripts[2], 3U, "middle", middle);
    script_init(&scripts[3], 4U, "idle", idle);
    csp_channel_init(&channel, 0U);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
