/* Buffer, overwriting buffer, broadcast and any: plain readers and writers, and an output guard on a broadcast. */
#include "script.h"

static script scripts[8];
static csp_buffer buffer, overwriting;
static csp_broadcast news;
static csp_broadcast_end ends[2];
static csp_any_channel any;
static int64_t buffered[2], overwritten[2];
static csp_alternative publishing;
static csp_guard publishing_guards[2];
static csp_timer timer;
static int64_t published = 70;
static const char *const names[] = {"buffer", "overwriting", "news", "any"};
static const csp_branches branches[] = {{sizeof(script), sizeof(script), 7U, 0U, 0U}};

static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};
static const script_list fills = {
    {.action = WRITE, .medium = &buffer.medium, .value = 1},
    {.action = WRITE, .medium = &buffer.medium, .value = 2},
    {.action = WRITE, .medium = &buffer.medium, .value = 3},
    {.action = WRITE, .medium = &overwriting.medium, .value = 4},
    {.action = WRITE, .medium = &overwriting.medium, .value = 5},
    {.action = WRITE, .medium = &overwriting.medium, .value = 6},
    {.action = SAY, .text = "has written all"},
    {.action = WRITE, .medium = &any.medium, .value = 7},
};
static const script_list empties = {
    {.action = DELAY, .value = 1},
    {.action = READ, .medium = &buffer.medium},
    {.action = SAY, .text = "buffer"},
    {.action = REPEAT, .jump = 1U, .value = 3},
    {.action = DELAY, .value = 1},
    {.action = READ, .medium = &overwriting.medium},
    {.action = SAY, .text = "overwriting"},
    {.action = READ, .medium = &overwriting.medium},
    {.action = SAY, .text = "overwriting"},
    {.action = WRITE, .medium = &any.medium, .value = 8},
};
static const script_list publishes = {
    {.action = WRITE, .medium = &news.medium, .value = 50},
    {.action = WRITE, .medium = &news.medium, .value = 60},
    {.action = SELECT, .alternative = &publishing, .jump = 3U},
    {.action = SAY, .text = "published"},
    {.action = SAY, .text = "ends"},
};
static const script_list first_reader = {
    {.action = READ, .medium = &ends[0].medium},
    {.action = REPEAT, .jump = 0U, .value = 3},
};
static const script_list second_reader = {
    {.action = DELAY, .value = 3},
    {.action = READ, .medium = &ends[1].medium},
    {.action = REPEAT, .jump = 0U, .value = 3},
};
static const script_list any_reader = {
    {.action = READ, .medium = &any.medium},
    {.action = SAY, .text = "any"},
};

int main(void)
{
    const script_step *const lists[] = {top,          fills,         empties,    publishes,
                                        first_reader, second_reader, any_reader, any_reader};
    static const char *const process_names[] = {"Top",   "fills",  "empties", "publishes",
                                                "first", "second", "any0",    "any1"};
    csp_buffer_init(&buffer, 0U, buffered, 2U, false);
    csp_buffer_init(&overwriting, 1U, overwritten, 2U, true);
    csp_broadcast_init(&news, 2U);
    csp_broadcast_end_init(&ends[0], &news);
    csp_broadcast_end_init(&ends[1], &news);
    csp_any_init(&any, 3U);
    csp_alternative_init(&publishing, publishing_guards, 2U, NULL, true);
    csp_guard_write(&publishing, 0U, &news.medium, &published, sizeof(published));
    csp_guard_after(&publishing, 1U, &timer);
    csp_delay(&publishing, 1U, 9000000);
    csp_enable_all(&publishing);
    for (uint32_t index = 0U; index < 8U; index++) {
        script_init(&scripts[index], index + 1U, process_names[index], lists[index]);
    }
    script_run(scripts, names, NULL, 0U, NULL, -1);
    return 0;
}
