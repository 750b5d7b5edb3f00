/* Channels with guards of the reader only, one guard or two: the reader also reads them plainly, a writer that waits is withdrawn, and a law offers. */
#include "script.h"

static script scripts[6];
static csp_guarded_channel sole, twice;
static csp_alternative first, second;
static csp_guard first_guards[2], second_guards[3];
static csp_timer timers[2];
static const char *const names[] = {"sole", "twice"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 3U, 0U, 0U}};

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};
static const script_list writes = {
    {.action = WRITE, .medium = &sole.channel.medium, .value = 1},
    {.action = WRITE, .medium = &sole.channel.medium, .value = 2},
    {.action = INTERRUPT, .process = &scripts[4], .rank = 2, .jump = 3U},
    {.action = SAY, .text = "its writer was withdrawn"},
    {.action = DELAY, .value = 5},
    {.action = WRITE, .medium = &sole.channel.medium, .value = 4},
    {.action = OFFER, .medium = &sole.channel.medium, .value = 5, .writes = true},
    {.action = OFFER, .medium = &twice.channel.medium, .value = 6, .writes = true},
    {.action = TOGETHER},
    {.action = WRITE, .medium = &twice.channel.medium, .value = 7},
    {.action = WRITE, .medium = &twice.channel.medium, .value = 8},
};
static const script_list reads = {
    {.action = DELAY, .value = 1},
    {.action = READ, .medium = &sole.channel.medium},
    {.action = SELECT, .alternative = &first, .jump = 3U},
    {.action = JUMP, .jump = 5U},
    {.action = SAY, .text = "time-out"},
    {.action = DELAY, .value = 3},
    {.action = SELECT, .alternative = &first, .jump = 7U},
    {.action = SAY, .text = "never: the writer was withdrawn"},
    {.action = SAY, .text = "time-out"},
    {.action = READ, .medium = &sole.channel.medium},
    {.action = SELECT, .alternative = &first, .jump = 11U},
    {.action = JUMP, .jump = 13U},
    {.action = SAY, .text = "time-out"},
    {.action = SELECT, .alternative = &second, .jump = 14U},
    {.action = JUMP, .jump = 17U},
    {.action = SAY, .text = "time-out"},
    {.action = SAY, .text = "never: the first guard is chosen"},
    {.action = READ, .medium = &twice.channel.medium},
    {.action = SELECT, .alternative = &second, .jump = 19U},
    {.action = SAY, .text = "never: the other guard is chosen"},
    {.action = SAY, .text = "time-out"},
    {.action = SAY, .text = "chose in turn"},
};
static const script_list idles = {{.action = DELAY, .value = 1}};
static const script_list withdrawn = {{.action = WRITE, .medium = &sole.channel.medium, .value = 3}};

static void time_out(csp_alternative *alternative, csp_timer *timer)
{
    csp_guard_after(alternative, 1U, timer);
    csp_delay(alternative, 1U, INT64_C(1000000));
    csp_enable_all(alternative);
}

int main(void)
{
    const script_step *const lists[] = {top, writes, reads, idles, withdrawn};
    static const char *const process_names[] = {"Top", "writes", "reads", "idles", "withdrawn"};
    for (uint32_t index = 0U; index < 5U; index++) {
        script_init(&scripts[index], index + 1U, process_names[index], lists[index]);
    }
    csp_guarded_init(&sole, 0U);
    csp_guarded_init(&twice, 1U);
    csp_alternative_init(&first, first_guards, 2U, NULL, false);
    csp_guard_read(&first, 0U, &sole.channel.medium, &scripts[2].value, sizeof(int64_t));
    time_out(&first, &timers[0]);
    csp_alternative_init(&second, second_guards, 3U, NULL, false);
    csp_guard_read(&second, 0U, &twice.channel.medium, &scripts[2].value, sizeof(int64_t));
    csp_guard_read(&second, 2U, &twice.channel.medium, &scripts[2].value, sizeof(int64_t));
    time_out(&second, &timers[1]);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
