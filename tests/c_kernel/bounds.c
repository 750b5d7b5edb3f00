/* Prints how many basic blocks of the kernel a run takes: bounds OPERATION SIZE TIMES. An operation is done TIMES times where there are SIZE others of its kind. */
#include <stdio.h>
#include <stdlib.h>

#include "script.h"

enum { MOST = 1000, ALARM = CSP_FIRST_EXCEPTION };

extern uint64_t steps_taken;

static script scripts[MOST + 4];
static csp_channel idle[MOST];
static csp_channel busy;
static csp_guarded_channel offered;
static csp_guarded_channel silent[MOST];
static csp_word words[2U * CSP_WORDS(MOST + 2)];
static csp_alternative choice;
static csp_guard guards[MOST + 2];
static csp_timer timer;
static const char *names[MOST + 4];
static csp_branches branches[] = {{sizeof(script), sizeof(script), 0U, 0U, 0U}};
static uint32_t used;

static const script_list top = {
    {.action = TRY, .exception = ALARM, .jump = 2U},
    {.action = PARALLEL, .branches = branches, .branch_runs = 1U},
};
static script_list idle_reads[MOST];
static const script_list long_delay = {{.action = DELAY, .value = 1000000}};
static const script_list raises = {{.action = DELAY, .value = 1}, {.action = RAISE, .exception = ALARM}};
static script_list first;
static script_list second;

static void add(const script_step *steps)
{
    used++;
    script_init(&scripts[used], used + 1U, "branch", steps);
    branches[0].count = used;
}

static void repeat(script_list list, script_step step, int64_t times)
{
    list[0] = step;
    list[1] = (script_step){.action = REPEAT, .jump = 0U, .value = times};
}

static void idle_readers(uint32_t size)
{
    for (uint32_t index = 0U; index < size; index++) {
        csp_channel_init(&idle[index], index + 3U);
        idle_reads[index][0] = (script_step){.action = READ, .medium = &idle[index].medium};
        add(idle_reads[index]);
    }
}

static void rendezvous(uint32_t size, int64_t times)
{
    idle_readers(size);
    csp_channel_init(&busy, 0U);
    repeat(first, (script_step){.action = WRITE, .medium = &busy.medium, .value = 1}, times);
    repeat(second, (script_step){.action = READ, .medium = &busy.medium}, times);
    add(first);
    add(second);
}

static void timers(uint32_t size, int64_t times)
{
    for (uint32_t index = 0U; index < size; index++) {
        add(long_delay);
    }
    repeat(first, (script_step){.action = DELAY, .value = 1}, times);
    add(first);
}

/* Each choice begins the time-out and does not need it any more. */
static void time_out(uint32_t size, int64_t times)
{
    for (uint32_t index = 0U; index < size; index++) {
        add(long_delay);
    }
    csp_guarded_init(&offered, 0U);
    csp_alternative_init(&choice, guards, 2U, NULL, false);
    repeat(first, (script_step){.action = SELECT, .alternative = &choice, .jump = 1U}, times);
    first[2] = first[1];
    first[2].jump = 0U;
    repeat(second, (script_step){.action = WRITE, .medium = &offered.channel.medium, .value = 1}, times);
    add(first);
    csp_guard_read(&choice, 0U, &offered.channel.medium, &scripts[used].value, sizeof(int64_t));
    csp_guard_after(&choice, 1U, &timer);
    csp_delay(&choice, 1U, INT64_C(500000000000));
    csp_enable_all(&choice);
    add(second);
}

/* One writer offers what a guard waits for; nobody offers what the others wait for. */
static void choose(uint32_t size, int64_t times, bool has_time_out)
{
    const uint16_t count = (uint16_t)(size + 1U + (has_time_out ? 1U : 0U));
    csp_guarded_init(&offered, 0U);
    csp_alternative_init(&choice, guards, count, words, false);
    repeat(first, (script_step){.action = SELECT, .alternative = &choice, .jump = 1U}, times);
    repeat(second, (script_step){.action = WRITE, .medium = &offered.channel.medium, .value = 1}, times);
    add(first);
    csp_guard_read(&choice, 0U, &offered.channel.medium, &scripts[used].value, sizeof(int64_t));
    for (uint32_t index = 1U; index <= size; index++) {
        csp_guarded_init(&silent[index - 1U], index + 3U);
        csp_guard_read(&choice, index, &silent[index - 1U].channel.medium, &scripts[used].value, sizeof(int64_t));
    }
    if (has_time_out) {
        csp_guard_after(&choice, size + 1U, &timer);
        csp_delay(&choice, size + 1U, INT64_C(500000000000));
    }
    csp_enable_all(&choice);
    add(second);
}

static void choice_of_inputs(uint32_t size, int64_t times)
{
    choose(size, times, false);
}

static void choice_with_time_out(uint32_t size, int64_t times)
{
    choose(size, times, true);
}

static void cancel(uint32_t size, int64_t times)
{
    (void)times;
    idle_readers(size);
    add(raises);
}

int main(int count, char **arguments)
{
    static const struct {
        const char *name;
        void (*make)(uint32_t size, int64_t times);
    } operations[] = {{"rendezvous", rendezvous}, {"timers", timers}, {"time-out", time_out},
                      {"choice", choice_of_inputs},     {"choice with time-out", choice_with_time_out},
                      {"cancel", cancel}};
    if (count == 4) {
        script_init(&scripts[0], 1U, "Top", top);
        for (size_t index = 0U; index < sizeof operations / sizeof operations[0]; index++) {
            if (strcmp(arguments[1], operations[index].name) == 0) {
                operations[index].make((uint32_t)strtoul(arguments[2], NULL, 10), strtol(arguments[3], NULL, 10));
            }
        }
        for (size_t index = 0U; index < sizeof names / sizeof names[0]; index++) {
            names[index] = "channel";
        }
        script_run(scripts, names, NULL, 0U, NULL, INT64_C(400000000000));
        (void)printf("steps %llu\n", (unsigned long long)steps_taken);
    }
    return 0;
}
