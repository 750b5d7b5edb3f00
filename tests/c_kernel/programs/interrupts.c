/* Interrupts: by another process, by a time-out, by the body itself; a body that ends before; a guard that an alternative chooses. */
#include "script.h"

static script scripts[9];
static csp_guarded_channel stop;
static csp_any_channel own, later;
static csp_buffer memory;
static int64_t memory_values[1];
static csp_alternative writing;
static csp_guard writing_guards[1];
static int64_t offered = 42;
static const char *const names[] = {"stop", "own", "later", "memory"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 3U, 0U, 0U}};

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};
static const script_list guarded = {
    {.action = INTERRUPT, .process = &scripts[4], .medium = &stop.channel.medium, .jump = 2U},
    {.action = SAY, .text = "not interrupted"},
    {.action = SAY, .text = "interrupted by stop"},
    {.action = INTERRUPT, .process = &scripts[5], .rank = 4, .jump = 5U},
    {.action = SAY, .text = "not interrupted"},
    {.action = SAY, .text = "interrupted by the time-out"},
    {.action = INTERRUPT, .process = &scripts[6], .medium = &own.medium, .jump = 8U},
    {.action = SAY, .text = "not interrupted"},
    {.action = SAY, .text = "interrupted by its own body"},
    {.action = INTERRUPT, .process = &scripts[7], .medium = &later.medium, .jump = 11U},
    {.action = SAY, .text = "the body has ended"},
    {.action = INTERRUPT, .process = &scripts[4], .medium = &later.medium, .jump = 13U},
    {.action = SAY, .text = "not interrupted"},
    {.action = SAY, .text = "chosen by an alternative"},
    {.action = INTERRUPT, .process = &scripts[8], .medium = &memory.medium, .jump = 16U},
    {.action = SAY, .text = "not interrupted"},
    {.action = SAY, .text = "interrupted by what its body has stored"},
};
static const script_list stopper = {
    {.action = DELAY, .value = 5},
    {.action = WRITE, .medium = &stop.channel.medium, .value = 1},
    {.action = DELAY, .value = 10},
    {.action = WRITE, .medium = &own.medium, .value = 2},
};
static const script_list chooser = {
    {.action = DELAY, .value = 30},
    {.action = SELECT, .alternative = &writing, .jump = 2U},
    {.action = SAY, .text = "has chosen"},
};
static const script_list ticks = {
    {.action = DELAY, .value = 2},
    {.action = SAY, .text = "works"},
    {.action = REPEAT, .jump = 0U, .value = 100},
};
static const script_list waits = {{.action = STOP}};
static const script_list interrupts_itself = {
    {.action = WRITE, .medium = &own.medium, .value = 9},
    {.action = SAY, .text = "never"},
};
static const script_list stores = {
    {.action = WRITE, .medium = &memory.medium, .value = 3},
    {.action = SAY, .text = "continues to its next communication"},
    {.action = WRITE, .medium = &memory.medium, .value = 4},
};
static const script_list ends = {{.action = DELAY, .value = 1}};

int main(void)
{
    const script_step *const lists[] = {top, guarded, stopper, chooser, ticks, waits, interrupts_itself, ends, stores};
    static const char *const process_names[] = {"Top", "guarded", "stopper", "chooser", "ticks", "waits", "own", "ends", "stores"};
    for (uint32_t index = 0U; index < 9U; index++) {
        script_init(&scripts[index], index + 1U, process_names[index], lists[index]);
    }
    csp_guarded_init(&stop, 0U);
    csp_any_init(&own, 1U);
    csp_any_init(&later, 2U);
    csp_buffer_init(&memory, 3U, memory_values, 1U, false);
    csp_alternative_init(&writing, writing_guards, 1U, NULL, false);
    csp_guard_write(&writing, 0U, &later.medium, &offered, sizeof(offered));
    csp_enable_all(&writing);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
