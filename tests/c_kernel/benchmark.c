/* The cost of the kernel's operations, in nanoseconds of processor time; the minimum of many short samples.
 *
 *   benchmark commstime            Prefix, Delta, Successor, Consumer: a communication
 *   benchmark alternative N        N writers, one fair alternative: a selection
 *   benchmark ring N               a value circulates through N processes: a hop; and bytes per process with its channel
 *   benchmark parallel             PAR of two processes that end immediately
 */
#define _POSIX_C_SOURCE 200112L

#include "csp.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { MOST = 100000, SAMPLES = 100, COMMUNICATIONS = 200000 };
enum { FINISHED = CSP_FIRST_EXCEPTION };

static double least = 1e30;
static double begun;

static double processor_time(void)
{
    struct timespec time;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return ((double)time.tv_sec * 1e9) + (double)time.tv_nsec;
}

static void sample_begins(void)
{
    begun = processor_time();
}

static void sample_ends(double operations)
{
    const double each = (processor_time() - begun) / operations;
    least = (each < least) ? each : least;
}

/* ---- Processes that pass a value on ---- */

struct relay {
    csp_process process;
    csp_channel *input;
    csp_channel *output;
    int64_t value;
};

struct delta {
    csp_process process;
    csp_channel *input;
    csp_channel *first;
    csp_channel *second;
    int64_t value;
};

struct consumer {
    csp_process process;
    csp_channel *input;
    csp_channel *output;
    int64_t value;
    int64_t count;
    int64_t sample;
    int64_t rounds;
    double operations;
};

enum { READS = 1, WRITES, WRITES_SECOND, FAILS };

#define PLACES(type, second)                                                                                           \
    {                                                                                                                  \
        {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},                                                              \
            {CSP_AT_READ, true, FAILS, offsetof(type, input), 0U, "", NULL},                                           \
            {CSP_AT_WRITE, true, FAILS, offsetof(type, second), 0U, "", NULL},                                         \
            {CSP_AT_WRITE, true, FAILS, offsetof(type, second), 0U, "", NULL},                                         \
        {                                                                                                              \
            CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL                                                             \
        }                                                                                                              \
    }

static const csp_place relay_places[] = PLACES(struct relay, output);
static const csp_place delta_places[] = PLACES(struct delta, second);
static const csp_place consumer_places[] = PLACES(struct consumer, output);

static csp_party *prefix_step(csp_kernel *csp, csp_party *party)
{
    struct relay *const self = (struct relay *)(void *)party;
    csp_progress progress;
    switch (party->state) {
    case 0:
        for (;;) {
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_channel_write(csp, party, self->output, &self->value, sizeof(self->value)), CSP_DONE, WRITES, failed)
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)), CSP_DONE, READS, failed)
        }
    case FAILS:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static csp_party *delta_step(csp_kernel *csp, csp_party *party)
{
    struct delta *const self = (struct delta *)(void *)party;
    csp_progress progress;
    switch (party->state) {
    case 0:
        for (;;) {
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)), CSP_DONE, READS, failed)
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_channel_write(csp, party, self->first, &self->value, sizeof(self->value)), CSP_DONE, WRITES, failed)
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_channel_write(csp, party, self->second, &self->value, sizeof(self->value)), CSP_DONE, WRITES_SECOND, failed)
        }
    case FAILS:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static csp_party *relay_step(csp_kernel *csp, csp_party *party)
{
    struct relay *const self = (struct relay *)(void *)party;
    csp_progress progress;
    switch (party->state) {
    case 0:
        for (;;) {
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)), CSP_DONE, READS, failed)
            self->value++;
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_channel_write(csp, party, self->output, &self->value, sizeof(self->value)), CSP_DONE, WRITES, failed)
        }
    case FAILS:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static csp_party *consumer_step(csp_kernel *csp, csp_party *party)
{
    struct consumer *const self = (struct consumer *)(void *)party;
    csp_progress progress;
    switch (party->state) {
    case 0:
        for (self->sample = 0; self->sample < SAMPLES; self->sample++) {
            sample_begins();
            for (self->count = 0; self->count < self->rounds; self->count++) {
                if (self->output != NULL) {
                    if (csp_refused(csp, party)) {
                        goto failed;
                    }
                    CSP_AWAIT(csp_channel_write(csp, party, self->output, &self->value, sizeof(self->value)), CSP_DONE, WRITES, failed)
                }
                if (csp_refused(csp, party)) {
                    goto failed;
                }
                CSP_AWAIT(csp_channel_read(csp, party, self->input, &self->value, sizeof(self->value)), CSP_DONE, READS, failed)
            }
            sample_ends((double)self->rounds * self->operations);
        }
        (void)csp_raise(csp, party, FINISHED, "");
        goto failed;
    case FAILS:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static const csp_class prefix_class = {prefix_step, relay_places, "Prefix", "", 0U, 0U, 0U};
static const csp_class delta_class = {delta_step, delta_places, "Delta", "", 0U, 0U, 0U};
static const csp_class relay_class = {relay_step, relay_places, "Successor", "", 0U, 0U, 0U};
static const csp_class consumer_class = {consumer_step, consumer_places, "Consumer", "", 0U, 0U, 0U};

/* ---- An alternative ---- */

struct writer {
    csp_process process;
    csp_guarded_channel *output;
    int64_t value;
};

struct chooser {
    csp_process process;
    int64_t value;
    int64_t count;
    int64_t sample;
    csp_alternative choice;
};

static csp_party *writer_step(csp_kernel *csp, csp_party *party)
{
    struct writer *const self = (struct writer *)(void *)party;
    csp_progress progress;
    switch (party->state) {
    case 0:
        for (;;) {
            if (csp_refused(csp, party)) {
                goto failed;
            }
            CSP_AWAIT(csp_guarded_write(csp, party, self->output, &self->value, sizeof(self->value)), CSP_DONE, WRITES, failed)
        }
    case FAILS:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static csp_party *chooser_step(csp_kernel *csp, csp_party *party)
{
    struct chooser *const self = (struct chooser *)(void *)party;
    csp_progress progress = CSP_DONE;
    switch (party->state) {
    case 0:
        for (self->sample = 0; self->sample < SAMPLES; self->sample++) {
            sample_begins();
            for (self->count = 0; self->count < COMMUNICATIONS; self->count++) {
                CSP_AWAIT(csp_select_inputs(csp, party, &self->choice, self->choice.count),
                          csp_select_again(csp, party, &self->choice), READS, failed)
            }
            sample_ends((double)COMMUNICATIONS);
        }
        (void)csp_raise(csp, party, FINISHED, "");
        goto failed;
    case FAILS:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static const csp_place writer_places[] = {
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
    {CSP_AT_WRITE, true, FAILS, offsetof(struct writer, output), 0U, "", NULL},
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
};
static const csp_place chooser_places[] = {
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
    {CSP_AT_ALTERNATIVE, false, FAILS, offsetof(struct chooser, choice), 0U, "", NULL},
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
    {CSP_AT_NOTHING, false, FAILS, 0U, 0U, "", NULL},
};
static const csp_class writer_class = {writer_step, writer_places, "Writer", "", 0U, 0U, 0U};
static const csp_class chooser_class = {chooser_step, chooser_places, "Chooser", "", 0U, 0U, 0U};

/* ---- Parallel ---- */

static csp_party *ends_step(csp_kernel *csp, csp_party *party)
{
    return csp_end(csp, party);
}

static const csp_class ends_class = {ends_step, relay_places, "Ends", "", 0U, 0U, 0U};

/* ---- Programs ---- */

struct program {
    csp_process process;
    csp_parallel parallel;
    csp_branches branches[3];
    uint32_t runs;
    int64_t count;
    int64_t sample;
    struct consumer consumer;
    struct chooser chooser;
    struct delta delta;
    struct relay relay[MOST];
    struct writer writer[1000];
};

static struct memory {
    csp_kernel kernel;
    struct program top;
} memory;
static csp_channel channel[MOST];
static csp_guarded_channel guarded[1000];
static csp_guard guards[1000];
static csp_word words[2U * CSP_WORDS(1000U)];

static csp_party *program_step(csp_kernel *csp, csp_party *party)
{
    struct program *const self = (struct program *)(void *)party;
    csp_progress progress = CSP_DONE;
    switch (party->state) {
    case 0:
        CSP_AWAIT(csp_par(csp, party, &self->parallel, self->branches, self->runs), csp_par_again(csp, party, &self->parallel), 1,
                  failed)
        return csp_end(csp, party);
    case 2:
    failed:
        csp_unwind(csp, party);
        return csp_catch(csp, FINISHED) ? csp_end(csp, party) : csp_fail(csp, party);
    default:
        return NULL;
    }
}

static csp_party *repeated_parallel_step(csp_kernel *csp, csp_party *party)
{
    struct program *const self = (struct program *)(void *)party;
    csp_progress progress = CSP_DONE;
    switch (party->state) {
    case 0:
        for (self->sample = 0; self->sample < SAMPLES; self->sample++) {
            sample_begins();
            for (self->count = 0; self->count < COMMUNICATIONS; self->count++) {
                CSP_AWAIT(csp_par(csp, party, &self->parallel, self->branches, self->runs),
                          csp_par_again(csp, party, &self->parallel), 1, failed)
            }
            sample_ends((double)COMMUNICATIONS);
        }
        return csp_end(csp, party);
    case 2:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static const csp_place program_places[] = {
    {CSP_AT_NOTHING, false, 2U, 0U, 0U, "", NULL},
    {CSP_AT_PARALLEL, false, 2U, offsetof(struct program, parallel), 0U, "", NULL},
    {CSP_AT_NOTHING, false, 2U, 0U, 0U, "", NULL},
};
static const csp_class program_class = {program_step, program_places, "Program", "", 0U, 0U, 0U};
static const csp_class repeated_parallel_class = {repeated_parallel_step, program_places, "Parallel", "", 0U, 0U, 0U};

static void branch(uint32_t run, size_t offset, size_t stride, uint32_t count)
{
    memory.top.branches[run].offset = (uint32_t)offset;
    memory.top.branches[run].stride = (uint32_t)stride;
    memory.top.branches[run].count = count;
    memory.top.runs = run + 1U;
}

static void connect(struct relay *relay, csp_channel *input, csp_channel *output)
{
    relay->input = input;
    relay->output = output;
}

static void consume(csp_channel *input, csp_channel *output, int64_t rounds, double operations)
{
    csp_process_init(&memory.top.consumer.process, &consumer_class, 2U);
    memory.top.consumer.input = input;
    memory.top.consumer.output = output;
    memory.top.consumer.rounds = rounds;
    memory.top.consumer.operations = operations;
}

static void build_commstime(void)
{
    csp_process_init(&memory.top.relay[0].process, &prefix_class, 3U);
    csp_process_init(&memory.top.relay[1].process, &relay_class, 4U);
    csp_process_init(&memory.top.delta.process, &delta_class, 5U);
    connect(&memory.top.relay[0], &channel[2], &channel[0]);
    connect(&memory.top.relay[1], &channel[1], &channel[2]);
    memory.top.delta.input = &channel[0];
    memory.top.delta.first = &channel[1];
    memory.top.delta.second = &channel[3];
    consume(&channel[3], NULL, COMMUNICATIONS / 4, 4.0);
    branch(0U, offsetof(struct program, relay), sizeof(struct relay), 2U);
    branch(1U, offsetof(struct program, delta), 0U, 1U);
    branch(2U, offsetof(struct program, consumer), 0U, 1U);
}

static void build_ring(uint32_t size)
{
    for (uint32_t index = 0U; index < (size - 1U); index++) {
        csp_process_init(&memory.top.relay[index].process, &relay_class, index + 3U);
        connect(&memory.top.relay[index], &channel[index], &channel[index + 1U]);
    }
    consume(&channel[size - 1U], &channel[0], (COMMUNICATIONS / (int64_t)size) + 1, (double)size);
    branch(0U, offsetof(struct program, relay), sizeof(struct relay), size - 1U);
    branch(1U, offsetof(struct program, consumer), 0U, 1U);
}

static void build_alternative(uint16_t count)
{
    csp_process_init(&memory.top.chooser.process, &chooser_class, 2U);
    csp_alternative_init(&memory.top.chooser.choice, guards, count, (count > CSP_WORD_BITS) ? words : NULL, false);
    for (uint16_t index = 0U; index < count; index++) {
        csp_guarded_init(&guarded[index], index);
        csp_process_init(&memory.top.writer[index].process, &writer_class, index + 3U);
        memory.top.writer[index].output = &guarded[index];
        csp_guard_read(&memory.top.chooser.choice, index, &guarded[index].channel.medium, &memory.top.chooser.value, sizeof(int64_t));
    }
    csp_enable_all(&memory.top.chooser.choice);
    branch(0U, offsetof(struct program, writer), sizeof(struct writer), count);
    branch(1U, offsetof(struct program, chooser), 0U, 1U);
}

static void build_parallel(void)
{
    csp_process_init(&memory.top.relay[0].process, &ends_class, 2U);
    csp_process_init(&memory.top.relay[1].process, &ends_class, 3U);
    branch(0U, offsetof(struct program, relay), sizeof(struct relay), 2U);
}

int main(int count, char **arguments)
{
    static const csp_program program = {.process = offsetof(struct memory, top.process)};
    csp_kernel *const csp = &memory.kernel;
    const char *const name = (count > 1) ? arguments[1] : "commstime";
    const long size = (count > 2) ? strtol(arguments[2], NULL, 10) : 10;
    csp_process_init(&memory.top.process, &program_class, 1U);
    for (uint32_t index = 0U; index < (uint32_t)MOST; index++) {
        csp_channel_init(&channel[index], index);
    }
    if (strcmp(name, "ring") == 0) {
        build_ring((uint32_t)size);
    } else if (strcmp(name, "alternative") == 0) {
        build_alternative((uint16_t)size);
    } else if (strcmp(name, "parallel") == 0) {
        csp_process_init(&memory.top.process, &repeated_parallel_class, 1U);
        build_parallel();
    } else {
        build_commstime();
    }
    csp_build(csp, &program, NULL);
    const csp_ending ending = csp_run(csp, -1);
    printf("%s: %.2f ns", name, least);
    if (strcmp(name, "ring") == 0) {
        printf(", %lu bytes per process", (unsigned long)(sizeof(struct relay) + sizeof(csp_channel)));
    }
    printf("\n");
    return (ending == CSP_TERMINATED) ? EXIT_SUCCESS : EXIT_FAILURE;
}
