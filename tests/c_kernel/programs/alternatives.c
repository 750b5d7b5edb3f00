/* A fair alternative chooses its guards in turn, a prioritized one does not; disabled guards, time-outs, two alternatives that meet. */
#include "script.h"

static script scripts[6];
static csp_guarded_channel left, right;
static csp_any_channel meeting;
static csp_alternative fair, prioritized, timed, writing, reading;
static csp_guard fair_guards[2], prioritized_guards[2], timed_guards[3], writing_guards[2], reading_guards[2];
static csp_timer timers[2];
static int64_t offered = 99;
static const char *const names[] = {"left", "right", "meeting"};
static const csp_branches writers[] = {{sizeof(script), sizeof(script), 3U, 0U, 0U}};
static const csp_branches alternating[] = {{4U * sizeof(script), sizeof(script), 2U, 0U, 0U}};

static const script_list top = {
    {.action = PARALLEL, .branches = writers, .branch_runs = 1U},
    {.action = PARALLEL, .branches = alternating, .branch_runs = 1U},
};
static const script_list left_writer = {
    {.action = WRITE, .medium = &left.channel.medium, .value = 1},
    {.action = REPEAT, .jump = 0U, .value = 6},
};
static const script_list right_writer = {
    {.action = WRITE, .medium = &right.channel.medium, .value = 2},
    {.action = REPEAT, .jump = 0U, .value = 6},
};
static const script_list chooser = {
    {.action = SELECT, .alternative = &fair, .jump = 1U},
    {.action = JUMP, .jump = 3U},
    {.action = JUMP, .jump = 3U},
    {.action = REPEAT, .jump = 0U, .value = 8},
    {.action = SELECT, .alternative = &prioritized, .jump = 5U},
    {.action = JUMP, .jump = 7U},
    {.action = JUMP, .jump = 7U},
    {.action = REPEAT, .jump = 4U, .value = 12},
    {.action = SELECT, .alternative = &timed, .jump = 9U},
    {.action = SAY, .text = "disabled"},
    {.action = SAY, .text = "never"},
    {.action = SAY, .text = "time-out"},
};
static const script_list meets_writing = {
    {.action = SELECT, .alternative = &writing, .jump = 1U},
    {.action = SAY, .text = "wrote"},
    {.action = SAY, .text = "continued"},
};
static const script_list meets_reading = {
    {.action = SELECT, .alternative = &reading, .jump = 1U},
    {.action = SAY, .text = "read"},
    {.action = SAY, .text = "continued"},
};

int main(void)
{
    script_init(&scripts[0], 1U, "Top", top);
    script_init(&scripts[1], 2U, "Top.left", left_writer);
    script_init(&scripts[2], 3U, "Top.right", right_writer);
    script_init(&scripts[3], 4U, "Top.chooser", chooser);
    script_init(&scripts[4], 5U, "Top.writing", meets_writing);
    script_init(&scripts[5], 6U, "Top.reading", meets_reading);
    csp_guarded_init(&left, 0U);
    csp_guarded_init(&right, 1U);
    csp_any_init(&meeting, 2U);
    csp_alternative_init(&fair, fair_guards, 2U, NULL, false);
    csp_guard_read(&fair, 0U, &left.channel.medium, &scripts[3].value, sizeof(int64_t));
    csp_guard_read(&fair, 1U, &right.channel.medium, &scripts[3].value, sizeof(int64_t));
    csp_enable_all(&fair);
    csp_alternative_init(&prioritized, prioritized_guards, 2U, NULL, true);
    csp_guard_read(&prioritized, 0U, &left.channel.medium, &scripts[3].value, sizeof(int64_t));
    csp_guard_read(&prioritized, 1U, &right.channel.medium, &scripts[3].value, sizeof(int64_t));
    csp_enable_all(&prioritized);
    csp_alternative_init(&timed, timed_guards, 3U, NULL, true);
    csp_guard_skip(&timed, 0U);
    csp_guard_read(&timed, 1U, &left.channel.medium, &scripts[3].value, sizeof(int64_t));
    csp_guard_after(&timed, 2U, &timers[0]);
    csp_enable_none(&timed);
    csp_enable(&timed, 1U);
    csp_enable(&timed, 2U);
    csp_delay(&timed, 2U, 3000000);
    csp_alternative_init(&writing, writing_guards, 2U, NULL, true);
    csp_guard_write(&writing, 0U, &meeting.medium, &offered, sizeof(offered));
    csp_guard_after(&writing, 1U, &timers[1]);
    csp_enable_all(&writing);
    csp_delay(&writing, 1U, 1000000);
    csp_alternative_init(&reading, reading_guards, 2U, NULL, true);
    csp_guard_read(&reading, 0U, &meeting.medium, &scripts[5].value, sizeof(int64_t));
    csp_guard_read(&reading, 1U, &left.channel.medium, &scripts[5].value, sizeof(int64_t));
    csp_enable_all(&reading);
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
